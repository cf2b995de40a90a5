// Shapes for WebGL 2. A shape is a mesh that is drawn once for each of its instances: numbers that its vertex shader
// takes as one ball, rod, line or piece of the floor. The light is that of libcore/scene/render.cpp, whose formulas
// these are; their numbers come from there.

const kTile = 16;  // pixels of the square that holds the light of a ball

const kShaderHead = () => "#version 300 es\nprecision highp float; precision highp int;\n" +
  Object.entries(data.light).map(([name, x]) => Array.isArray(x) ? `const vec3 ${name} = vec3(${x});` : `const float ${name} = float(${x});`).join("\n") + `
  uniform mat3 axes;     // of the picture: right, up, near
  uniform vec3 centre;   // of the picture
  uniform vec3 scale;    // from the model's unit to that of the screen
  uniform vec3 low, high;
  uniform vec2 depths;   // of what is nearest and farthest; equal without fog
  uniform vec2 window;   // pixels
  uniform float rim;     // width of the rim; of a rod 0 for the shape itself
  uniform float edge;    // how white the rim of a rod is
  uniform float opacity;
  uniform float dot_size;  // a pixel of the screen, in the model's unit
  uniform bool occluded;
  uniform sampler2D occluders, lights;  // of each ball a row, and a tile
  uniform vec2 tiles;
  const float tile_part = ${1 - 1 / kTile};
  vec2 tileOf(int number) { return vec2(number % int(tiles.x), number / int(tiles.x)); }
  vec3 seen(vec3 place) { return (place - centre) * axes; }
  vec4 onScreen(vec3 s) { return vec4(s * scale, 1.0); }
`;

const kShade = `
  out vec4 colour;
  float pale(float z) {
    float deep = depths.x - depths.y;
    return deep > 0.0 ? fog * clamp((depths.x - z) / deep, 0.0, 1.0) : 0.0;
  }
  /// @param seen_normal right, up, near
  vec3 lit(vec3 own, vec3 seen_normal, float open_part) {
    vec3 n = seen_normal * vec3(1, -1, 1);
    float bright = (ambient + diffuse * max(0.0, dot(n, light_from))) * open_part;
    return min(vec3(1), bright * own + shine * pow(max(0.0, dot(n, half_way)), 40.0));
  }`;
// A ball is a square, whose fragments find the sphere in it; the rim is flat, and lies behind the middle.
const kBallVertex = `
  in vec3 unit, tint;
  in vec4 ball;
  out vec2 aside;  // of the middle, in radii
  flat out vec4 middle;  // seen; the radius
  flat out vec3 own;
  flat out int number;
  void main() {
    own = tint;
    number = gl_InstanceID;
    middle = vec4(seen(ball.xyz), ball.w);
    aside = (2.0 * unit.xy - 1.0) * (1.0 + (rim + dot_size) / ball.w);
    gl_Position = onScreen(middle.xyz + vec3(ball.w * aside, 0));
  }`;
const kBallFragment = kShade + `
  in vec2 aside;
  flat in vec4 middle;
  flat in vec3 own;
  flat in int number;
  void main() {
    float away = length(aside), radius = middle.w;
    float whole = clamp((1.0 - away) * radius / dot_size + 0.5, 0.0, 1.0);
    float covered = clamp((1.0 - away) * radius / dot_size + rim / dot_size + 0.5, 0.0, 1.0);
    if (covered == 0.0) discard;
    vec3 n = away < 1.0 ? vec3(aside, sqrt(1.0 - away * away)) : vec3(aside / away, 0);
    float z = middle.z + radius * (whole > 0.0 ? n.z : -outline_depth);
    gl_FragDepth = 0.5 + 0.5 * z * scale.z;
    // The light of the ball's visible half is in a tile, whose parts are of equal size on the sphere.
    float open_part = occluded ? texture(lights, (tileOf(number) + 0.5 + 0.5 * tile_part * n.xy / sqrt(1.0 + n.z)) / tiles).r * most_open : 1.0;
    vec3 shown = mix(outline_light * own, lit(own, n, open_part), whole);
    colour = vec4(mix(shown, vec3(1), pale(z)), covered * opacity);
  }`;
// What the neighbours leave of the light to each part of a ball's visible half.
const kLightVertex = `
  in vec3 unit;
  in vec4 ball;
  out vec2 part;
  flat out vec4 middle;
  flat out int number;
  void main() {
    number = gl_InstanceID;
    middle = ball;
    part = (2.0 * unit.xy - 1.0) / tile_part;
    gl_Position = vec4(2.0 * (tileOf(number) + unit.xy) / tiles - 1.0, 0, 1);
  }`;
const kLightFragment = `
  in vec2 part;
  flat in vec4 middle;
  flat in int number;
  out vec4 colour;
  void main() {
    float flat_part = min(1.0, dot(part, part));
    vec3 n = axes * vec3(part * inversesqrt(max(1.0, dot(part, part))) * sqrt(2.0 - flat_part), 1.0 - flat_part);
    vec3 at = middle.xyz + middle.w * n;
    float sum = 0.0;
    for (int i = 0; i < textureSize(occluders, 0).x; ++i) {
      vec4 other = texelFetch(occluders, ivec2(i, number), 0);
      if (!(other.w > 0.0)) break;
      vec3 way = other.xyz - at;
      float away2 = dot(way, way);
      float size = min(1.0, other.w * other.w / away2) - 1.0 / (reach * reach);
      float above = max(0.0, 0.5 + 0.5 * dot(n, way) / sqrt(away2));
      if (size > 0.0) sum += above * sqrt(above) * size;
    }
    colour = vec4(clamp(open * pow(1.0 + fading * sum / 16.0, -16.0), least_open, most_open) / most_open);
  }`;
// Unit is on a circle around the rod, and says where along it; below 0 it is of the flat end. The rim is flat here, too.
const kRodVertex = `
  in vec3 unit, tint;
  in vec4 from, to;
  out vec3 normal;
  flat out vec3 own;
  out float z;
  void main() {
    own = tint;
    float size = max(distance(from.xyz, to.xyz), 1e-12);
    vec3 way = (to.xyz - from.xyz) / size;
    vec3 side = normalize(cross(way, abs(way.z) < 0.9 ? vec3(0, 0, 1) : vec3(1, 0, 0)));
    vec3 out_ = unit.x * side + unit.y * cross(way, side);
    float part = max(unit.z, 0.0), radius = mix(from.w, to.w, part);
    vec3 middle = mix(from.xyz, to.xyz, part);
    normal = unit.z < 0.0 ? -way : normalize(size * out_ + (from.w - to.w) * way);
    vec3 s = seen(middle + (radius + rim) * out_);
    if (rim > 0.0) s.z = seen(middle).z - outline_depth * radius;
    z = s.z;
    gl_Position = onScreen(s);
  }`;
const kRodFragment = kShade + `
  in vec3 normal;
  flat in vec3 own;
  in float z;
  void main() {
    vec3 shown = rim > 0.0 ? mix(outline_light * own, vec3(1), edge) : lit(own, normalize(normal) * axes, 1.0);
    colour = vec4(mix(shown, vec3(1), pale(z)), 1);
  }`;
const kLineVertex = `
  in vec3 unit, from, to;
  out float beside;  // of its middle, in pixels
  void main() {
    vec4 a = onScreen(seen(from)), b = onScreen(seen(to));
    vec2 way = normalize((b - a).xy * window);
    beside = (unit.y - 0.5) * (rim + 2.0);
    gl_Position = mix(a, b, unit.x) + vec4(2.0 * beside * vec2(-way.y, way.x) / window, 0, 0);
  }`;
const kLineFragment = `
  in float beside;
  out vec4 colour;
  void main() { colour = vec4(box_rgb, clamp(0.5 * rim + 0.5 - abs(beside), 0.0, 1.0)); }`;
// What a ball leaves of the light on the floor, least in its middle; or the floor, with what the darkest shadow leaves.
const kFloorVertex = `
  in vec3 unit;
  in vec4 place;  // its middle, and half its sides
  in float dark;
  out vec2 inside, at;
  flat out float is_shadow;
  void main() {
    inside = 2.0 * unit.xy - 1.0;
    at = place.xy + place.zw * inside;
    is_shadow = dark;
    gl_Position = onScreen(seen(vec3(at, low.z)));
  }`;
const kFloorFragment = `
  in vec2 inside, at;
  flat in float is_shadow;
  out vec4 colour;
  void main() {
    if (any(lessThan(at, low.xy)) || any(greaterThan(at, high.xy))) discard;
    float u = max(0.0, 1.0 - dot(inside, inside));
    colour = vec4(vec3(is_shadow > 0.0 ? 1.0 - u * u : floor_light * (1.0 - shadow)), 1);
  }`;

/// A grid of (columns + 1) x (rows + 1) vertices, which place(u, v) puts somewhere, and its triangles,
/// which are seen from the side where u goes to the right and v up.
function mesh(columns, rows, place) {
  const vertices = [], corners = [];
  for (let j = 0; j <= rows; ++j)
    for (let i = 0; i <= columns; ++i) {
      vertices.push(...place(i / columns, j / rows));
      const k = j * (columns + 1) + i, up = k + columns + 1;
      if (i < columns && j < rows) corners.push(k, k + 1, up, up, k + 1, up + 1);
    }
  return { vertices: new Float32Array(vertices), corners: new Uint16Array(corners) };
}

const circle = (u) => [Math.cos(2 * Math.PI * u), Math.sin(2 * Math.PI * u)];
const squareMesh = () => mesh(1, 1, (u, v) => [u, v, 0]);
const rodMesh = () => mesh(24, 3, (u, v) => v === 0 ? [0, 0, -1] : [...circle(u), [-1, 0, 1][Math.round(3 * v) - 1]]);

function makeProgram(gl, vertexText, fragmentText) {
  const program = gl.createProgram();
  for (const [kind, text] of [[gl.VERTEX_SHADER, vertexText], [gl.FRAGMENT_SHADER, fragmentText]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, kShaderHead() + text);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost())
    throw new Error(gl.getProgramInfoLog(program) + gl.getAttachedShaders(program).map((s) => gl.getShaderInfoLog(s)).join(""));
  gl.useProgram(program);
  gl.uniform1i(gl.getUniformLocation(program, "lights"), 1);  // the occluders are in texture 0
  return program;
}

/// @param layout what of an instance is how many numbers
/// @return a function that draws instances, whose numbers are in one list
function makeShape(gl, program, { vertices, corners }, layout) {
  const array = gl.createVertexArray(), instances = gl.createBuffer();
  const attribute = (name, size, stride, offset, divisor) => {
    const at = gl.getAttribLocation(program, name);
    if (at < 0) return;
    gl.enableVertexAttribArray(at);
    gl.vertexAttribPointer(at, size, gl.FLOAT, false, 4 * stride, 4 * offset);
    gl.vertexAttribDivisor(at, divisor);
  };
  gl.bindVertexArray(array);
  gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
  gl.bufferData(gl.ARRAY_BUFFER, vertices, gl.STATIC_DRAW);
  attribute("unit", 3, 3, 0, 0);
  gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
  gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, corners, gl.STATIC_DRAW);
  gl.bindBuffer(gl.ARRAY_BUFFER, instances);
  const stride = Object.values(layout).reduce((a, b) => a + b);
  let offset = 0;
  for (const name in layout) attribute(name, layout[name], stride, (offset += layout[name]) - layout[name], 1);
  return (numbers, uniforms) => {
    if (numbers.length === 0) return;
    gl.useProgram(program);
    for (const name in uniforms) {
      const at = gl.getUniformLocation(program, name), x = [uniforms[name]].flat();
      if (x.length === 9) gl.uniformMatrix3fv(at, false, x);
      else if (typeof x[0] === "boolean") gl.uniform1i(at, x[0]);
      else gl[`uniform${x.length}fv`](at, x);
    }
    gl.bindVertexArray(array);
    gl.bindBuffer(gl.ARRAY_BUFFER, instances);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(numbers), gl.DYNAMIC_DRAW);
    gl.drawElementsInstanced(gl.TRIANGLES, corners.length, gl.UNSIGNED_SHORT, 0, numbers.length / stride);
  };
}
