// The programs that the graphics card runs for each sphere and each line.
#pragma once

namespace hapgrid {

// Coordinates are those of a Drawing: rays, y down, z towards the viewer. `depths` has the least
// and the greatest z of all.

inline constexpr const char* kBallVertex = R"(#version 330 core
uniform vec2 size;
layout(location = 0) in vec4 place;  // x, y, z, radius
layout(location = 1) in vec4 paint;
flat out vec4 ball;
flat out vec4 colour;
void main() {
  vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0;
  vec2 at = place.xy + place.w * corner;
  gl_Position = vec4(2.0 * at.x / size.x - 1.0, 1.0 - 2.0 * at.y / size.y, 0.0, 1.0);
  ball = place;
  colour = paint;
}
)";

// The light is that of shade() in libcore/scene/render.cpp.
inline constexpr const char* kBallFragment = R"(#version 330 core
uniform vec2 size;
uniform vec2 depths;
flat in vec4 ball;
flat in vec4 colour;
out vec4 fragment;
void main() {
  vec2 d = (vec2(gl_FragCoord.x, size.y - gl_FragCoord.y) - ball.xy) / ball.w;
  float rest = 1.0 - dot(d, d);
  if (rest < 0.0) discard;
  vec3 normal = vec3(d, sqrt(rest));
  float diffuse = max(0.0, dot(normal, vec3(-0.4243, -0.5657, 0.7071)));
  float shine = 0.25 * pow(max(0.0, dot(normal, vec3(-0.2297, -0.3062, 0.9239))), 40.0);
  float rim = min(1.0, 0.45 + 1.6 * normal.z);
  fragment = vec4(min(vec3(1.0), (0.4 + 0.6 * diffuse) * rim * colour.rgb + shine), colour.a);
  gl_FragDepth = (depths.y - (ball.z + ball.w * normal.z)) / (depths.y - depths.x);
}
)";

inline constexpr const char* kLineVertex = R"(#version 330 core
uniform vec2 size;
layout(location = 0) in vec4 start;  // x, y, z, half the width
layout(location = 1) in vec4 end;    // x, y, z
layout(location = 2) in vec4 paint;
flat out vec4 from;
flat out vec4 to;
flat out vec4 colour;
void main() {
  vec2 way = end.xy - start.xy;
  vec2 along = length(way) > 0.0 ? normalize(way) : vec2(1.0, 0.0);
  vec2 across = vec2(-along.y, along.x);
  bool far = (gl_VertexID & 1) != 0;
  vec2 at = (far ? end.xy + start.w * along : start.xy - start.w * along) +
            start.w * across * (gl_VertexID < 2 ? 1.0 : -1.0);
  gl_Position = vec4(2.0 * at.x / size.x - 1.0, 1.0 - 2.0 * at.y / size.y, 0.0, 1.0);
  from = start;
  to = end;
  colour = paint;
}
)";

inline constexpr const char* kLineFragment = R"(#version 330 core
uniform vec2 size;
uniform vec2 depths;
flat in vec4 from;
flat in vec4 to;
flat in vec4 colour;
out vec4 fragment;
void main() {
  vec2 at = vec2(gl_FragCoord.x, size.y - gl_FragCoord.y) - from.xy;
  vec2 way = to.xy - from.xy;
  float square = dot(way, way);
  float t = square > 0.0 ? clamp(dot(at, way) / square, 0.0, 1.0) : 0.0;
  if (distance(at, t * way) > from.w) discard;
  fragment = colour;
  gl_FragDepth = (depths.y - mix(from.z, to.z, t)) / (depths.y - depths.x);
}
)";

}  // namespace hapgrid
