"use strict";
// Draws points with WebGL 2: one program, one buffer a column, one range of points a layer and frame.

const VERTEX = `#version 300 es
layout(location = 0) in vec3 place;       // 0 to 1 between the corners.
layout(location = 1) in uint motion;
layout(location = 2) in uint segment;
layout(location = 3) in float confidence;
uniform mat4 clipFromWorld;
uniform vec3 low, span;
uniform vec3 palette[10];
uniform int colouring;                     // 0 motion, 1 segment, 2 confidence.
uniform float pixels, paleness, smallest;
out vec3 colour;
vec3 ramp(float x) {                       // Cividis, in five steps: blue is doubtful, yellow is sure.
  vec3 c[5] = vec3[](vec3(0., .13, .30), vec3(.25, .31, .42), vec3(.49, .48, .47), vec3(.74, .68, .41), vec3(.99, .91, .22));
  float at = clamp(x, 0., 1.) * 4.;
  int i = min(int(at), 3);
  return mix(c[i], c[i + 1], at - float(i));
}
void main() {
  gl_Position = clipFromWorld * vec4(low + place * span, 1.);
  gl_PointSize = max(smallest, pixels / gl_Position.w);
  uint number = colouring == 1 ? segment : motion;
  vec3 own = colouring == 2 && motion < 8u ? ramp(confidence) : palette[number];
  colour = mix(own, vec3(1.), paleness);
}`;

const FRAGMENT = `#version 300 es
precision mediump float;
in vec3 colour;
uniform int ring;
out vec4 shown;
void main() {
  float far = length(gl_PointCoord - .5);
  if (far > .5) discard;
  shown = vec4(ring == 1 && far < .28 ? vec3(1.) : colour, 1.);
}`;

class Drawing {
  constructor(canvas) {
    this.canvas = canvas;
    this.gl = canvas.getContext("webgl2", { antialias: true });
    if (!this.gl) throw new Error("WebGL 2 is not available");
    this.program = this.linked();
    this.gl.useProgram(this.program);
    this.gl.enable(this.gl.DEPTH_TEST);
    this.gl.clearColor(0.973, 0.973, 0.965, 1);
    this.at = {};
    this.name("clipFromWorld low span palette colouring pixels paleness smallest ring");
  }

  name(names) {
    for (const name of names.split(" ")) this.at[name] = this.gl.getUniformLocation(this.program, name);
  }

  linked() {
    const gl = this.gl;
    const program = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    return program;
  }

  // Puts columns of points on the graphics card; `places` are uint16 in threes, the others one byte a point.
  cloud({ places, motion, segment, confidence }, low, span) {
    const gl = this.gl;
    const array = gl.createVertexArray();
    gl.bindVertexArray(array);
    const columns = [places, motion, segment, confidence];
    columns.forEach((column, location) => {
      gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
      gl.bufferData(gl.ARRAY_BUFFER, column, gl.STATIC_DRAW);
      gl.enableVertexAttribArray(location);
      if (location === 0) gl.vertexAttribPointer(0, 3, gl.UNSIGNED_SHORT, true, 0, 0);
      else if (location === 3) gl.vertexAttribPointer(3, 1, gl.UNSIGNED_BYTE, true, 0, 0);
      else gl.vertexAttribIPointer(location, 1, gl.UNSIGNED_BYTE, 0, 0);
    });
    return { array, low, span };
  }

  begin(clipFromWorld, palette, colouring) {
    const gl = this.gl;
    const scale = Math.min(window.devicePixelRatio || 1, 2);
    const width = Math.round(this.canvas.clientWidth * scale), height = Math.round(this.canvas.clientHeight * scale);
    if (this.canvas.width !== width || this.canvas.height !== height) Object.assign(this.canvas, { width, height });
    gl.viewport(0, 0, width, height);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.uniformMatrix4fv(this.at.clipFromWorld, false, clipFromWorld);
    gl.uniform3fv(this.at.palette, palette);
    gl.uniform1i(this.at.colouring, colouring);
    this.scale = scale;
  }

  points(cloud, first, count, { size, paleness = 0, ring = false, smallest = 1.5 }) {
    if (count <= 0) return;
    const gl = this.gl;
    gl.bindVertexArray(cloud.array);
    gl.uniform3fv(this.at.low, cloud.low);
    gl.uniform3fv(this.at.span, cloud.span);
    gl.uniform1f(this.at.pixels, size * this.canvas.height);
    gl.uniform1f(this.at.smallest, smallest * this.scale);
    gl.uniform1f(this.at.paleness, paleness);
    gl.uniform1i(this.at.ring, ring ? 1 : 0);
    gl.drawArrays(gl.POINTS, first, count);
  }
}

// A column-major matrix: a perspective view of 40 degrees from a place on a sphere around the target.
function clipFromWorld({ target, distance, yaw, pitch }, aspect) {
  const [sy, cy, sp, cp] = [Math.sin(yaw), Math.cos(yaw), Math.sin(pitch), Math.cos(pitch)];
  const right = [cy, 0, -sy], back = [sy * cp, sp, cy * cp], up = [-sy * sp, cp, -cy * sp];
  const eye = target.map((value, axis) => value + distance * back[axis]);
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const f = 1 / Math.tan((20 * Math.PI) / 180), near = 0.05, far = 200;
  const a = (far + near) / (near - far), b = (2 * far * near) / (near - far);
  const [tx, ty, tz] = [-dot(right, eye), -dot(up, eye), -dot(back, eye)];
  const g = f / aspect;
  const column = (k) => [g * right[k], f * up[k], a * back[k], -back[k]];
  return new Float32Array([...column(0), ...column(1), ...column(2), g * tx, f * ty, a * tz + b, -tz]);
}
