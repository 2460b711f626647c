// Draw an episode with WebGL 2: one light, soft shadows from a depth image, colours as in the videos.

import { between, lookingAt, minus, parallel, perspective, placed, plus, product, unit } from "./matrices.js";

const NEAR = 0.03, FAR = 12; // metres
const SHADOW_TEXELS = 2048, SHADOW_HALF = 1.5, SHADOW_MIDDLE = [0.35, 0, 0.2]; // the shadows of this cube are drawn
const EFFORTS = [{ radius: 0, scale: 0.6 }, { radius: 1, scale: 1 }, { radius: 2, scale: 2 }]; // of shadows' edges, in samples, and of pixels
const AROUND = [0.886, 0.898, 0.906]; // the colour of walls

const BODY = `#version 300 es
in vec3 corner; in vec3 normal; in vec2 place;
uniform mat4 body, view, light;
out vec3 at, facing; out vec2 texel; out vec4 lit;
void main() {
  vec4 world = body * vec4(corner, 1.0);
  at = world.xyz; facing = mat3(body) * normal; texel = place;
  lit = light * (world + vec4(0.004 * normalize(facing), 0.0));
  gl_Position = view * world;
}`;

const SURFACE = `#version 300 es
precision highp float; precision highp sampler2DShadow;
in vec3 at, facing; in vec2 texel; in vec4 lit;
uniform vec3 colour, towards, eye, around; uniform bool textured; uniform int radius;
uniform sampler2D image; uniform sampler2DShadow shadow;
out vec4 shown;
void main() {
  vec3 normal = normalize(gl_FrontFacing ? facing : -facing), ahead = normalize(eye - at);
  vec3 paint = textured ? colour * texture(image, texel).rgb : colour;
  vec3 place = lit.xyz / lit.w * 0.5 + 0.5;
  float bright = 0.0;
  for (int row = -radius; row <= radius; row++) for (int column = -radius; column <= radius; column++)
    bright += texture(shadow, place + vec3(vec2(row, column) * 2.2 / ${SHADOW_TEXELS}.0, -0.0008));
  bright = any(greaterThan(abs(place - 0.5), vec3(0.5))) ? 1.0 : bright / float((2 * radius + 1) * (2 * radius + 1));
  float slope = max(dot(normal, towards), 0.0);
  float gloss = pow(max(dot(normal, normalize(towards + ahead)), 0.0), 24.0);
  vec3 result = paint * (0.6 + 0.44 * slope * bright + 0.06 * normal.z) + 0.1 * gloss * bright;
  shown = vec4(mix(result, around, smoothstep(1.6, 3.6, length(at.xy - vec2(0.4, 0.0)))), 1.0);
}`;

const DEPTH = `#version 300 es
in vec3 corner;
uniform mat4 body, light;
void main() { gl_Position = light * body * vec4(corner, 1.0); }`;

const NOTHING = `#version 300 es
precision highp float;
void main() {}`;

export class Renderer {
  // Raise an error if the browser has no WebGL 2.
  constructor(canvas, episode) {
    const gl = canvas.getContext("webgl2", { antialias: true });
    if (gl === null) throw new Error("this browser has no WebGL 2");
    Object.assign(this, { canvas, episode, gl, time: null, effort: EFFORTS.length - 1 });
    this.towards = unit(episode.light);
    this.light = product(parallel(SHADOW_HALF), lookingAt(plus(SHADOW_MIDDLE, this.towards, 2 * SHADOW_HALF), SHADOW_MIDDLE));
    this.surfaces = program(gl, BODY, SURFACE);
    this.depths = program(gl, DEPTH, NOTHING);
    this.bodies = episode.bodies.map((body) => ({ ...body, pieces: body.pieces.map((piece) => loaded(gl, piece)) }));
    this.textures = [];
    this.shadow = shadowMap(gl);
    gl.enable(gl.DEPTH_TEST);
  }

  // Read the textures, which takes a moment.
  async load() {
    this.textures = await Promise.all(this.episode.images.map(async (image) => texture(this.gl, await createImageBitmap(image))));
  }

  // Draw the bodies at a time in seconds, as an eye sees them.
  draw(time, eye, target) {
    const { gl, canvas, surfaces } = this;
    if (gl.isContextLost()) return;
    if (time !== this.time) this.move(time);
    const { radius, scale: most } = EFFORTS[this.effort], scale = Math.min(most, devicePixelRatio);
    const width = Math.round(canvas.clientWidth * scale), height = Math.round(canvas.clientHeight * scale);
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.viewport(0, 0, width, height);
    gl.clearColor(...AROUND, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.useProgram(surfaces.program);
    const view = product(perspective(this.episode.view.angle, width / height, NEAR, FAR), lookingAt(eye, target));
    gl.uniformMatrix4fv(surfaces.view, false, view);
    gl.uniformMatrix4fv(surfaces.light, false, this.light);
    gl.uniform3fv(surfaces.towards, this.towards);
    gl.uniform3fv(surfaces.around, AROUND);
    gl.uniform3fv(surfaces.eye, eye);
    gl.uniform1i(surfaces.radius, radius);
    gl.uniform1i(surfaces.image, 0);
    gl.uniform1i(surfaces.shadow, 1);
    gl.activeTexture(gl.TEXTURE1);
    gl.bindTexture(gl.TEXTURE_2D, this.shadow.depth);
    gl.activeTexture(gl.TEXTURE0);
    for (const { pieces, pose } of this.bodies) {
      gl.uniformMatrix4fv(surfaces.body, false, pose);
      for (const piece of pieces) {
        const image = piece.image === null ? undefined : this.textures[piece.image];
        gl.uniform3fv(surfaces.colour, piece.colour);
        gl.uniform1i(surfaces.textured, image === undefined ? 0 : 1);
        gl.bindTexture(gl.TEXTURE_2D, image ?? null);
        gl.bindVertexArray(piece.arrays);
        gl.drawElements(gl.TRIANGLES, piece.count, piece.type, 0);
      }
    }
  }

  // Move all bodies to a time, and take the depth image from the light.
  move(time) {
    const { gl, depths } = this;
    const span = spanAt(this.episode.times, time);
    for (const body of this.bodies) body.pose = poseAt(body, span);
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.shadow.frame);
    gl.viewport(0, 0, SHADOW_TEXELS, SHADOW_TEXELS);
    gl.clear(gl.DEPTH_BUFFER_BIT);
    gl.useProgram(depths.program);
    gl.uniformMatrix4fv(depths.light, false, this.light);
    for (const { pieces, pose, name } of this.bodies) {
      if (name === "floor") continue;
      gl.uniformMatrix4fv(depths.body, false, pose);
      for (const piece of pieces) {
        gl.bindVertexArray(piece.arrays);
        gl.drawElements(gl.TRIANGLES, piece.count, piece.type, 0);
      }
    }
    this.time = time;
  }

  // Draw more quickly from now on, with fewer pixels and sharper shadows.
  lower() {
    this.effort = Math.max(0, this.effort - 1);
  }

  close() {
    this.gl.getExtension("WEBGL_lose_context")?.loseContext();
  }
}

// The recorded frames before and after a time, and the share of the time between them that has passed.
function spanAt(times, time) {
  const found = times.findIndex((each) => each > time), next = found < 0 ? times.length - 1 : found;
  const last = found < 0 ? next : Math.max(0, next - 1);
  return { last, next, share: next === last ? 0 : (time - times[last]) / (times[next] - times[last]) };
}

// The pose of a body between two frames, as a matrix.
function poseAt({ at, turn, path }, { last, next, share }) {
  if (path === null) return placed(at, turn);
  const row = (values, number, width) => [...values.subarray(number * width, (number + 1) * width)];
  const [here, there] = [last, next].map((number) => row(path.translation, number, 3));
  const turned = between(row(path.rotation, last, 4), row(path.rotation, next, 4), share);
  return placed(plus(here, minus(there, here), share), turned);
}

function program(gl, ...sources) {
  const made = gl.createProgram();
  [gl.VERTEX_SHADER, gl.FRAGMENT_SHADER].forEach((kind, i) => {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, sources[i]);
    gl.compileShader(shader);
    gl.attachShader(made, shader);
  });
  ["corner", "normal", "place"].forEach((name, i) => gl.bindAttribLocation(made, i, name));
  gl.linkProgram(made);
  if (!gl.getProgramParameter(made, gl.LINK_STATUS) && !gl.isContextLost()) throw new Error(gl.getProgramInfoLog(made));
  const found = { program: made };
  for (const name of ["body", "view", "light", "colour", "towards", "eye", "around", "textured", "radius", "image", "shadow"]) found[name] = gl.getUniformLocation(made, name);
  return found;
}

function loaded(gl, piece) {
  const arrays = gl.createVertexArray();
  gl.bindVertexArray(arrays);
  [piece.corners, piece.normals, piece.places].forEach((values, i) => {
    if (values === null) return;
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, values, gl.STATIC_DRAW);
    gl.enableVertexAttribArray(i);
    gl.vertexAttribPointer(i, i === 2 ? 2 : 3, gl.FLOAT, false, 0, 0);
  });
  gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
  gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, piece.triangles, gl.STATIC_DRAW);
  const type = piece.triangles.BYTES_PER_ELEMENT === 2 ? gl.UNSIGNED_SHORT : gl.UNSIGNED_INT;
  return { arrays, type, count: piece.triangles.length, colour: piece.colour, image: piece.image };
}

function texture(gl, image) {
  const made = gl.createTexture(), sharp = gl.getExtension("EXT_texture_filter_anisotropic");
  gl.bindTexture(gl.TEXTURE_2D, made);
  gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, gl.RGBA, gl.UNSIGNED_BYTE, image);
  gl.generateMipmap(gl.TEXTURE_2D);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR_MIPMAP_LINEAR);
  if (sharp) gl.texParameterf(gl.TEXTURE_2D, sharp.TEXTURE_MAX_ANISOTROPY_EXT, 8);
  return made;
}

function shadowMap(gl) {
  const depth = gl.createTexture(), frame = gl.createFramebuffer();
  gl.bindTexture(gl.TEXTURE_2D, depth);
  gl.texStorage2D(gl.TEXTURE_2D, 1, gl.DEPTH_COMPONENT24, SHADOW_TEXELS, SHADOW_TEXELS);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_COMPARE_MODE, gl.COMPARE_REF_TO_TEXTURE);
  for (const each of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, each, gl.LINEAR);
  for (const each of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, each, gl.CLAMP_TO_EDGE);
  gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
  gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.TEXTURE_2D, depth, 0);
  return { depth, frame };
}
