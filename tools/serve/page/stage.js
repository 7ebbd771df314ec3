// Camera, light, floor and robot.

import {GROUND, SKY, SKY_STRENGTH, SUN_STRENGTH, light} from './facets.js';
import {inSoftware} from './software.js';

export class Stage {
  constructor(canvas) {
    this.canvas = canvas;
    // Anti-aliasing is expensive on a processor.
    this.smooth = /[?&]smooth/.test(location.search) || !inSoftware;
    // Blending with the page's background is not needed either.
    this.renderer = new THREE.WebGLRenderer({canvas, antialias: this.smooth, alpha: this.smooth});
    this.renderer.setClearColor(0x18212b, this.smooth ? 0 : 1);
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(32, 1, 0.01, 50);
    this.camera.up.set(0, 0, 1);
    this.camera.position.set(0.4, -1.6, 0.7);
    this.hemisphere = new THREE.HemisphereLight(SKY, GROUND, SKY_STRENGTH);
    this.sun = new THREE.DirectionalLight(SKY, SUN_STRENGTH);
    this.scene.add(this.hemisphere, this.sun);
    this.makeControls();
    this.robots = [];
    this.sharpness = 1;
    this.dirty = true;
    this.framed = this.touched = false;
    this.resize();
    new ResizeObserver(() => this.resize()).observe(canvas);
  }

  makeControls() {
    if (this.controls) this.controls.dispose();
    this.controls = new THREE.OrbitControls(this.camera, this.canvas);
    this.controls.addEventListener('change', () => { this.dirty = true; });
    this.controls.addEventListener('start', () => { this.touched = true; });
    this.controls.minDistance = 0.05;
    this.controls.maxDistance = 15;
    this.controls.screenSpacePanning = true;
  }

  resize() {
    const {clientWidth: width, clientHeight: height} = this.canvas;
    if (!width || !height) return;
    this.renderer.setPixelRatio(this.sharpness * Math.min(window.devicePixelRatio || 1, 2));
    this.renderer.setSize(width, height, false);
    // Until the user has chosen a view, the object is fitted to the image.
    if (!this.touched && Math.abs(this.camera.aspect - width / height) > 0.02) this.framed = false;
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.dirty = true;
  }

  /** Pixels drawn per screen pixel, along a side, 0 to 1. */
  setSharpness(sharpness) {
    if (sharpness === this.sharpness) return;
    this.sharpness = sharpness;
    this.resize();
  }

  /** The base of the first arm in O: its z is up, and the floor is at its origin. */
  setBase(base) {
    if (this.floor) this.scene.remove(this.floor);
    this.floor = null;
    if (!base) return;
    const turn = new THREE.Quaternion(...base.quaternion);
    const up = new THREE.Vector3(0, 0, 1).applyQuaternion(turn);
    if (this.camera.up.distanceTo(up) > 1e-6) {
      this.camera.up.copy(up);
      this.makeControls();
    }
    this.hemisphere.position.copy(up);
    this.floor = new THREE.GridHelper(4, 40, 0x49617a, 0x2a3845);
    this.floor.material.transparent = true;
    this.floor.material.opacity = 0.55;
    this.floor.rotation.x = Math.PI / 2;
    const frame = new THREE.Group();
    frame.add(this.floor);
    frame.position.fromArray(base.at);
    frame.quaternion.copy(turn);
    this.floor = frame;
    this.scene.add(frame);
  }

  setRobots(robots) {
    for (const robot of this.robots) this.scene.remove(robot.group);
    this.robots = robots.map((robot) => this.makeRobot(robot));
  }

  makeRobot({links, shapes}) {
    const group = new THREE.Group(), parts = [];
    for (let i = 0; i < links; ++i) {
      parts.push(new THREE.Group());
      group.add(parts[i]);
    }
    for (const shape of shapes) {
      const [a, b, c] = shape.size;
      let geometry;
      if (shape.kind === 'box') geometry = new THREE.BoxBufferGeometry(a, b, c);
      else if (shape.kind === 'sphere') geometry = new THREE.SphereBufferGeometry(a, 28, 18);
      else geometry = new THREE.CylinderBufferGeometry(a, a, b, 32).rotateX(Math.PI / 2);
      // Muted, so that the shape's colours stand out.
      const colour = new THREE.Color(...shape.colour).lerp(new THREE.Color(0x8b98a5), 0.45);
      const mesh = new THREE.Mesh(geometry, new THREE.MeshLambertMaterial({color: colour}));
      mesh.position.fromArray(shape.at);
      mesh.quaternion.set(...shape.quaternion);
      parts[shape.link].add(mesh);
    }
    group.visible = false;
    this.scene.add(group);
    return {group, parts};
  }

  placeRobot(index, poses, shown) {
    const robot = this.robots[index];
    if (!robot) return;
    robot.group.visible = shown && Boolean(poses);
    if (!poses) return;
    robot.parts.forEach((part, i) => {
      part.position.set(poses[7 * i], poses[7 * i + 1], poses[7 * i + 2]);
      part.quaternion.set(poses[7 * i + 3], poses[7 * i + 4], poses[7 * i + 5], poses[7 * i + 6]);
    });
  }

  /** Looks at a box of O from the direction in which its longest extent is across the image. */
  frame(box) {
    const middle = box.getCenter(new THREE.Vector3()), size = box.getSize(new THREE.Vector3());
    const up = this.camera.up.clone();
    const axes = [new THREE.Vector3(1, 0, 0), new THREE.Vector3(0, 1, 0), new THREE.Vector3(0, 0, 1)];
    const across = axes.filter((a) => Math.abs(a.dot(up)) < 0.7)
        .sort((a, b) => Math.abs(size.dot(b)) - Math.abs(size.dot(a)))[0];
    const towards = new THREE.Vector3().crossVectors(across, up).normalize();
    // Not from behind the arm.
    const arm = this.floor ? this.floor.position.clone().sub(middle) : new THREE.Vector3();
    if (arm.dot(towards) > 0.3 * arm.length()) towards.negate();
    const wide = Math.abs(size.dot(across)), high = Math.max(Math.abs(size.dot(up)), 0.3 * size.length());
    const half = Math.tan(this.camera.fov * Math.PI / 360);
    const distance = 0.56 * Math.max(wide / (half * this.camera.aspect), high / half) + 0.5 * size.length();
    this.controls.target.copy(middle);
    this.camera.position.copy(middle).addScaledVector(towards, distance)
        .addScaledVector(up, 0.42 * distance).addScaledVector(across, 0.22 * distance);
    this.controls.update();
    this.framed = true;
    this.dirty = true;
  }

  /** Pixels of the canvas (CSS) of a point in O, with z in (-1, 1) in front of the camera. */
  toScreen(point) {
    const p = point.clone().project(this.camera);
    return {x: (p.x + 1) / 2 * this.canvas.clientWidth, y: (1 - p.y) / 2 * this.canvas.clientHeight, z: p.z};
  }

  ray(x, y) {
    const caster = new THREE.Raycaster();
    caster.setFromCamera({x: 2 * x / this.canvas.clientWidth - 1, y: 1 - 2 * y / this.canvas.clientHeight}, this.camera);
    return caster;
  }

  /** Intersection of a pixel's ray with the plane through `point` that faces the camera. */
  onPlane(x, y, point) {
    const normal = this.camera.getWorldDirection(new THREE.Vector3());
    const plane = new THREE.Plane().setFromNormalAndCoplanarPoint(normal, point);
    return this.ray(x, y).ray.intersectPlane(plane, new THREE.Vector3());
  }

  render() {
    this.sun.position.copy(this.camera.position).addScaledVector(this.camera.up, 0.6);
    this.sun.target.position.copy(this.controls.target);
    this.sun.target.updateMatrixWorld();
    this.camera.updateMatrixWorld();
    light.up.value.copy(this.hemisphere.position).transformDirection(this.camera.matrixWorldInverse);
    light.sun.value.subVectors(this.sun.position, this.sun.target.position).transformDirection(this.camera.matrixWorldInverse);
    this.renderer.render(this.scene, this.camera);
    this.dirty = false;
  }
}
