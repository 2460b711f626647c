// Read the .glb file of an episode: bodies with pieces and poses, times, actions, the first view and the light.

const MAGIC = 0x46546c67;
const ARRAYS = { 5126: Float32Array, 5123: Uint16Array, 5125: Uint32Array };
const WIDTHS = { SCALAR: 1, VEC3: 3, VEC4: 4, VEC2: 2 };

export function readEpisode(buffer) {
  const head = new DataView(buffer);
  if (head.getUint32(0, true) !== MAGIC) throw new Error("this is not a .glb file");
  const length = head.getUint32(12, true), begin = 28 + length;
  const file = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 20, length)));

  function array(number) {
    const { bufferView, componentType, count, type } = file.accessors[number];
    return new ARRAYS[componentType](buffer, begin + file.bufferViews[bufferView].byteOffset, count * WIDTHS[type]);
  }

  function piece({ attributes, indices, material }) {
    const surface = file.materials[material].pbrMetallicRoughness;
    const texture = surface.baseColorTexture;
    return {
      corners: array(attributes.POSITION),
      normals: array(attributes.NORMAL),
      places: attributes.TEXCOORD_0 === undefined ? null : array(attributes.TEXCOORD_0),
      triangles: array(indices),
      colour: surface.baseColorFactor.slice(0, 3).map(encoded),
      image: texture === undefined ? null : file.textures[texture.index].source,
    };
  }

  const world = file.nodes[file.scenes[0].nodes[0]].children.map((number) => file.nodes[number]);
  const bodies = world.filter((node) => node.mesh !== undefined).map((node) => ({
    name: node.name,
    pieces: file.meshes[node.mesh].primitives.map(piece),
    at: node.translation,
    turn: node.rotation,
    path: null,
  }));
  let times = new Float32Array(1);
  for (const { channels, samplers } of file.animations ?? []) {
    for (const { sampler, target } of channels) {
      const body = bodies[world.indexOf(file.nodes[target.node])];
      times = array(samplers[sampler].input);
      body.path = { ...body.path, [target.path]: array(samplers[sampler].output) };
    }
  }
  const images = (file.images ?? []).map(({ bufferView, mimeType }) => {
    const { byteOffset, byteLength } = file.bufferViews[bufferView];
    return new Blob([new Uint8Array(buffer, begin + byteOffset, byteLength)], { type: mimeType });
  });
  const eye = world.find((node) => node.camera !== undefined);
  return {
    bodies, times, images,
    actions: file.scenes[0].extras.actions,
    light: file.scenes[0].extras.light,
    view: { eye: eye.translation, target: eye.extras.target, angle: file.cameras[eye.camera].perspective.yfov },
  };
}

// A component of a colour as it is shown, from its linear intensity.
function encoded(part) {
  return part <= 0.0031308 ? 12.92 * part : 1.055 * part ** (1 / 2.4) - 0.055;
}
