// Whether pictures are drawn without a graphics processor: then a processor pays for each pixel.

function drawsInSoftware() {
  const gl = document.createElement('canvas').getContext('webgl');
  const info = gl && gl.getExtension('WEBGL_debug_renderer_info');
  const name = info ? gl.getParameter(info.UNMASKED_RENDERER_WEBGL) : '';
  if (gl) gl.getExtension('WEBGL_lose_context').loseContext();
  return /swiftshader|llvmpipe|softpipe|software/i.test(name);
}

export const inSoftware = drawsInSoftware();

/** A pen for lines and texts, which are drawn by the processor where a graphics processor is only feigned. */
export const penOf = (canvas) => canvas.getContext('2d', {willReadFrequently: inSoftware});
