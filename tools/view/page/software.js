// Whether images are rendered without a graphics processor: each pixel then costs processor time.

function drawsInSoftware() {
  const gl = document.createElement('canvas').getContext('webgl');
  const info = gl && gl.getExtension('WEBGL_debug_renderer_info');
  const name = info ? gl.getParameter(info.UNMASKED_RENDERER_WEBGL) : '';
  if (gl) gl.getExtension('WEBGL_lose_context').loseContext();
  return /swiftshader|llvmpipe|softpipe|software/i.test(name);
}

export const inSoftware = drawsInSoftware();

/** Canvas context for lines and texts, drawn by the processor if the graphics processor is emulated. */
export const penOf = (canvas) => canvas.getContext('2d', {willReadFrequently: inSoftware});
