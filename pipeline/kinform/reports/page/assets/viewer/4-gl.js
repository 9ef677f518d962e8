// The few things that are asked of WebGL2: programs, buffers, a target for picking.

function programOf(gl, source) {
  const program = gl.createProgram();
  for (const [kind, text] of [[gl.VERTEX_SHADER, source.vertex], [gl.FRAGMENT_SHADER, source.fragment]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS) && !gl.isContextLost()) throw new Error(gl.getShaderInfoLog(shader));
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost()) throw new Error(gl.getProgramInfoLog(program));
  const at = {};
  const count = gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS);
  for (let k = 0; k < count; k++) {
    const name = gl.getActiveUniform(program, k).name;
    at[name] = gl.getUniformLocation(program, name);
  }
  return { program, at };
}

function bufferOf(gl, target, data) {
  const buffer = gl.createBuffer();
  gl.bindBuffer(target, buffer);
  gl.bufferData(target, data, gl.STATIC_DRAW);
  return buffer;
}

// Facets and edges of one mesh.
class MeshBuffers {
  constructor(gl, mesh) {
    Object.assign(this, { low: mesh.low, size: mesh.size, triangles: mesh.triangles.length, lines: mesh.lines.length });
    const places = bufferOf(gl, gl.ARRAY_BUFFER, mesh.places);
    const normals = bufferOf(gl, gl.ARRAY_BUFFER, mesh.normals);
    this.solid = gl.createVertexArray();
    gl.bindVertexArray(this.solid);
    gl.bindBuffer(gl.ARRAY_BUFFER, places);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 3, gl.UNSIGNED_SHORT, true, 0, 0);
    gl.bindBuffer(gl.ARRAY_BUFFER, normals);
    gl.enableVertexAttribArray(1);
    gl.vertexAttribPointer(1, 4, gl.BYTE, true, 0, 0);
    bufferOf(gl, gl.ELEMENT_ARRAY_BUFFER, mesh.triangles);
    this.edge = gl.createVertexArray();
    gl.bindVertexArray(this.edge);
    gl.bindBuffer(gl.ARRAY_BUFFER, places);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 3, gl.UNSIGNED_SHORT, true, 0, 0);
    bufferOf(gl, gl.ELEMENT_ARRAY_BUFFER, mesh.lines);
    gl.bindVertexArray(null);
  }
}

// A square of two triangles, repeated for each row of an instance buffer.
class Instances {
  constructor(gl, corners, data, columns, kind, normalized) {
    const width = data.BYTES_PER_ELEMENT;
    const stride = width * columns.reduce((sum, n) => sum + n, 0);
    this.count = stride ? data.byteLength / stride : 0;
    this.array = gl.createVertexArray();
    this.gl = gl;
    this.pointers = { data: bufferOf(gl, gl.ARRAY_BUFFER, data), columns, kind, normalized, width, stride };
    gl.bindVertexArray(this.array);
    bufferOf(gl, gl.ARRAY_BUFFER, new Float32Array(corners));
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 2, gl.FLOAT, false, 0, 0);
    columns.forEach((_, k) => { gl.enableVertexAttribArray(k + 1); gl.vertexAttribDivisor(k + 1, 1); });
    gl.bindVertexArray(null);
  }

  draw(start, count) {
    const { gl } = this;
    const { data, columns, kind, normalized, width, stride } = this.pointers;
    gl.bindVertexArray(this.array);
    gl.bindBuffer(gl.ARRAY_BUFFER, data);
    let offset = start * stride;
    columns.forEach((n, k) => {
      gl.vertexAttribPointer(k + 1, n, kind, normalized, stride, offset);
      offset += n * width;
    });
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, count);
  }
}

// Where numbers are drawn as colours, to find what lies under the pointer.
class PickTarget {
  constructor(gl) {
    this.gl = gl;
    this.frame = gl.createFramebuffer();
    this.colour = gl.createTexture();
    this.depth = gl.createRenderbuffer();
  }

  begin(width, height) {
    const { gl } = this;
    if (this.width !== width || this.height !== height) {
      Object.assign(this, { width, height });
      gl.bindTexture(gl.TEXTURE_2D, this.colour);
      gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA8, width, height, 0, gl.RGBA, gl.UNSIGNED_BYTE, null);
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
      gl.bindRenderbuffer(gl.RENDERBUFFER, this.depth);
      gl.renderbufferStorage(gl.RENDERBUFFER, gl.DEPTH_COMPONENT24, width, height);
      gl.bindFramebuffer(gl.FRAMEBUFFER, this.frame);
      gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, this.colour, 0);
      gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.RENDERBUFFER, this.depth);
    }
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.frame);
  }

  read(x, y) {
    const { gl } = this;
    const pixel = new Uint8Array(4);
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.frame);
    gl.readPixels(x, y, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    return pixel[0] | (pixel[1] << 8) | (pixel[2] << 16);
  }
}
