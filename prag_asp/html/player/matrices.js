// Vectors, quaternions (x, y, z, w) and 4 x 4 matrices in column order, as plain arrays.

export const minus = (a, b) => a.map((each, i) => each - b[i]);
export const plus = (a, b, scale = 1) => a.map((each, i) => each + scale * b[i]);
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
export const dot = (a, b) => a.reduce((sum, each, i) => sum + each * b[i], 0);
export const unit = (a) => { const length = Math.hypot(...a) || 1; return a.map((each) => each / length); };

export function product(a, b) {
  const result = new Array(16).fill(0);
  for (let column = 0; column < 4; column++)
    for (let row = 0; row < 4; row++)
      for (let k = 0; k < 4; k++) result[4 * column + row] += a[4 * k + row] * b[4 * column + k];
  return result;
}

export function placed([x, y, z], [a, b, c, d]) {
  return [
    1 - 2 * (b * b + c * c), 2 * (a * b + c * d), 2 * (a * c - b * d), 0,
    2 * (a * b - c * d), 1 - 2 * (a * a + c * c), 2 * (b * c + a * d), 0,
    2 * (a * c + b * d), 2 * (b * c - a * d), 1 - 2 * (a * a + b * b), 0,
    x, y, z, 1,
  ];
}

// The transformation from the scene to a camera with x to the right, y up and z backwards.
export function lookingAt(eye, target, up = [0, 0, 1]) {
  const back = unit(minus(eye, target)), right = unit(cross(up, back)), above = cross(back, right);
  const axes = [0, 1, 2].flatMap((i) => [right[i], above[i], back[i], 0]);
  return [...axes, -dot(right, eye), -dot(above, eye), -dot(back, eye), 1];
}

export function perspective(angle, aspect, near, far) {
  const focal = 1 / Math.tan(angle / 2), depth = near - far;
  return [focal / aspect, 0, 0, 0, 0, focal, 0, 0, 0, 0, (near + far) / depth, -1, 0, 0, 2 * near * far / depth, 0];
}

// The projection of a cube with a half side, whose middle is as far ahead as its side is long.
export function parallel(half) {
  return [1 / half, 0, 0, 0, 0, 1 / half, 0, 0, 0, 0, -1 / half, 0, 0, 0, -2, 1];
}

// The rotation between two others on the shorter way, at a share from 0 to 1.
export function between(one, two, share) {
  const sign = dot(one, two) < 0 ? -1 : 1;
  return unit(one.map((each, i) => each + share * (sign * two[i] - each)));
}
