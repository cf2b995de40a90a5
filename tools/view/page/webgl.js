// Shapes for WebGL 2. A shape is a mesh that is drawn once for each of its instances: numbers that its vertex shader
// takes as one ball, rod, line or piece of the floor. The light is that of libcore/scene/render.cpp, whose formulas
// these are; their numbers come from there.

const kShaderHead = () => "#version 300 es\nprecision highp float; precision highp int;\n" +
  Object.entries(data.light).map(([name, x]) => Array.isArray(x) ? `const vec3 ${name} = vec3(${x});` : `const float ${name} = float(${x});`).join("\n") + `
  uniform mat3 axes;     // of the picture: right, up, near
  uniform vec3 centre;   // of the picture
  uniform vec3 scale;    // from the model's unit to that of the screen
  uniform vec3 low, high;
  uniform vec2 depths;   // of what is nearest and farthest; equal without fog
  uniform vec2 window;   // pixels
  uniform float rim;     // width of the dark rim; 0 for the shape itself
  uniform float opacity;
  uniform bool occluded;
  uniform sampler2D occluders;  // a row for each ball
  vec3 seen(vec3 place) { return (place - centre) * axes; }
  vec4 onScreen(vec3 s) { return vec4(s * scale, 1.0); }
`;

// A solid's place and normal; the rim is flat, and lies behind the middle.
const kSolidVertex = (parts, body) => `
  in vec3 unit;
  ${parts}
  in vec3 tint;
  out vec3 at, normal;
  flat out vec3 own;
  flat out int number;
  out float z;
  void main() {
    own = tint;
    number = gl_InstanceID;
    vec3 middle;
    float radius;
    ${body}
    vec3 s = seen(at);
    if (rim > 0.0) s.z = seen(middle).z - outline_depth * radius;
    z = s.z;
    gl_Position = onScreen(s);
  }`;
const kBallVertex = kSolidVertex("in vec4 ball;", `
    middle = ball.xyz;
    radius = ball.w;
    normal = unit;
    at = middle + (radius + rim) * unit;`);
// Unit is on a circle around the rod, and says where along it; below 0 it is of the flat end.
const kRodVertex = kSolidVertex("in vec4 from, to;", `
    float size = max(distance(from.xyz, to.xyz), 1e-12);
    vec3 way = (to.xyz - from.xyz) / size;
    vec3 side = normalize(cross(way, abs(way.z) < 0.9 ? vec3(0, 0, 1) : vec3(1, 0, 0)));
    vec3 out_ = unit.x * side + unit.y * cross(way, side);
    float part = max(unit.z, 0.0);
    middle = mix(from.xyz, to.xyz, part);
    radius = mix(from.w, to.w, part);
    normal = unit.z < 0.0 ? -way : normalize(size * out_ + (from.w - to.w) * way);
    at = middle + (radius + rim) * out_;`);
const kSolidFragment = `
  in vec3 at, normal;
  flat in vec3 own;
  flat in int number;
  in float z;
  out vec4 colour;
  float openLight(vec3 n) {
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
    return clamp(open * pow(1.0 + fading * sum / 16.0, -16.0), least_open, most_open);
  }
  void main() {
    float deep = depths.x - depths.y;
    float pale = deep > 0.0 ? fog * clamp((depths.x - z) / deep, 0.0, 1.0) : 0.0;
    vec3 lit = outline_light * own;
    if (rim == 0.0) {
      vec3 n = normalize(normal) * axes * vec3(1, -1, 1);
      if (opacity < 1.0 && n.z < 0.0) discard;
      float bright = (ambient + diffuse * max(0.0, dot(n, light_from))) * (occluded ? openLight(normalize(normal)) : 1.0);
      lit = min(vec3(1), bright * own + shine * pow(max(0.0, dot(n, half_way)), 40.0));
    }
    colour = vec4(mix(lit, vec3(1), pale), opacity);
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
const rodMesh = () => mesh(32, 3, (u, v) => v === 0 ? [0, 0, -1] : [...circle(u), [-1, 0, 1][Math.round(3 * v) - 1]]);
function ballMesh(columns) {
  return mesh(columns, columns / 2, (u, v) => [...circle(u).map((x) => x * Math.sin(Math.PI * v)), -Math.cos(Math.PI * v)]);
}

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
