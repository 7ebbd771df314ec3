// Lighting of a shape's surface: facet by facet, by the sky, the ground and a sun. Normals come
// from the derivatives of the positions in the image, so that a moved mesh costs the script
// nothing, and there is no specular term: in software rendering the three.js material with both
// takes four times as long.

export const SKY = 0xffffff, GROUND = 0x8090a0, SKY_STRENGTH = 0.86, SUN_STRENGTH = 0.4;

/** Directions to the sky's top and to the sun in the camera's frame, for all surfaces. */
export const light = {up: {value: new THREE.Vector3(0, 1, 0)}, sun: {value: new THREE.Vector3(0, 0, 1)}};

const VERTEX = `
#ifndef USE_COLOR
uniform vec3 tint;
#endif
varying vec3 own;
varying vec3 place;
void main() {
#ifdef USE_COLOR
  own = color;
#else
  own = tint;
#endif
  vec4 seen = modelViewMatrix * vec4(position, 1.0);
  place = seen.xyz;
  gl_Position = projectionMatrix * seen;
}`;

const FRAGMENT = `
uniform vec3 up, sun, sky, ground;
uniform float sunStrength, opacity;
varying vec3 own;
varying vec3 place;
void main() {
  vec3 normal = normalize(cross(dFdx(place), dFdy(place)));
  vec3 shine = mix(ground, sky, 0.5 + 0.5 * dot(normal, up)) + sunStrength * max(dot(normal, sun), 0.0);
  gl_FragColor = vec4(own * shine, opacity);
}`;

/** With the nodes' own colours, or one `tint` with `opacity`; `options`: those of any material. */
export function facets({tint, opacity = 1, ...options}) {
  const sky = new THREE.Color(SKY).multiplyScalar(SKY_STRENGTH), ground = new THREE.Color(GROUND).multiplyScalar(SKY_STRENGTH);
  return new THREE.ShaderMaterial({
    ...options, vertexShader: VERTEX, fragmentShader: FRAGMENT, extensions: {derivatives: true}, transparent: opacity < 1,
    vertexColors: tint === undefined ? THREE.VertexColors : THREE.NoColors,
    uniforms: {...light, sky: {value: sky}, ground: {value: ground}, sunStrength: {value: SUN_STRENGTH},
      tint: {value: new THREE.Color(tint)}, opacity: {value: opacity}},
  });
}
