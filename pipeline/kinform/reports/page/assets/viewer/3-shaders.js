// The programs of the viewer. Every program writes either a shaded colour or, for picking, a number as a colour.

const GLSL = {
  // Facets: matt, lit from above the eye; see-through where `ghost` is set, denser towards the outline.
  solid: {
    vertex: `#version 300 es
      layout(location = 0) in vec3 place;
      layout(location = 1) in vec4 normal;
      uniform mat4 model, view, projection;
      uniform vec3 low, size;
      out vec3 seen, facing, where;
      void main() {
        vec4 world = model * vec4(low + place * size, 1.0);
        vec4 eye = view * world;
        where = world.xyz;
        seen = eye.xyz;
        facing = mat3(view) * mat3(model) * normal.xyz;
        gl_Position = projection * eye;
      }`,
    fragment: `#version 300 es
      precision highp float;
      in vec3 seen, facing, where;
      uniform vec3 colour;
      uniform vec4 cut;
      uniform float ghost, glow, veil;
      out vec4 shown;
      void main() {
        if (dot(cut.xyz, where) > cut.w) discard;
        vec3 n = normalize(facing);
        vec3 eye = normalize(-seen);
        if (dot(n, eye) < 0.0) n = -n;
        float key = max(dot(n, normalize(vec3(-0.35, 0.75, 0.60))), 0.0);
        float fill = max(dot(n, normalize(vec3(0.70, 0.05, 0.45))), 0.0);
        float sky = 0.5 + 0.5 * n.y;
        float rim = 1.0 - max(dot(n, eye), 0.0);
        vec3 lit = colour * (0.34 + 0.20 * sky + 0.50 * key + 0.16 * fill);
        lit += vec3(0.055) * pow(max(dot(reflect(-eye, n), normalize(vec3(-0.35, 0.75, 0.60))), 0.0), 18.0);
        lit = mix(lit, vec3(1.0), glow * (0.10 + 0.35 * rim));
        float dense = mix(1.0, 0.05 + 0.42 * rim * rim, ghost) * veil;
        // what a cut lays open: the inside of facets, of one tone as a cut face has
        if (cut.xyz != vec3(0.0) && ghost == 0.0 && !gl_FrontFacing) lit = mix(colour, vec3(0.5), 0.25) * 0.72;
        shown = vec4(lit * dense, dense);
      }`,
  },
  // Lines where surfaces meet, in the depth that they have: facets are drawn a little further away (polygon offset).
  edge: {
    vertex: `#version 300 es
      layout(location = 0) in vec3 place;
      uniform mat4 model, view, projection;
      uniform vec3 low, size;
      out vec3 where;
      void main() {
        vec4 world = model * vec4(low + place * size, 1.0);
        vec4 eye = view * world;
        where = world.xyz;
        gl_Position = projection * eye;
      }`,
    fragment: `#version 300 es
      precision highp float;
      in vec3 where;
      uniform vec4 colour, cut;
      out vec4 shown;
      void main() {
        if (dot(cut.xyz, where) > cut.w) discard;
        shown = vec4(colour.rgb * colour.a, colour.a);
      }`,
  },
  // Samples of contact patches: discs that lie in the surface.
  disc: {
    vertex: `#version 300 es
      layout(location = 0) in vec2 corner;
      layout(location = 1) in vec3 place;
      layout(location = 2) in vec3 normal;
      layout(location = 3) in float radius;
      uniform mat4 model, view, projection;
      uniform vec3 low, size;
      uniform float largest;
      out vec2 across;
      void main() {
        vec3 n = normalize(normal * 2.0 - 1.0);
        vec3 u = normalize(cross(abs(n.z) < 0.9 ? vec3(0, 0, 1) : vec3(1, 0, 0), n));
        vec3 v = cross(n, u);
        across = corner;
        vec3 world = low + place * size + 1.15 * radius * largest * (corner.x * u + corner.y * v);
        gl_Position = projection * view * model * vec4(world, 1.0);
      }`,
    fragment: `#version 300 es
      precision mediump float;
      in vec2 across;
      uniform vec4 colour;
      out vec4 shown;
      void main() {
        if (dot(across, across) > 1.0) discard;
        shown = colour;
      }`,
  },
  // Strokes of a constant width on the screen, for axes, arrows and arcs.
  stroke: {
    vertex: `#version 300 es
      layout(location = 0) in vec2 corner;
      layout(location = 1) in vec3 from;
      layout(location = 2) in vec3 to;
      uniform mat4 model, view, projection;
      uniform vec2 screen;
      uniform float width;
      out float along;
      void main() {
        vec4 a = projection * view * model * vec4(from, 1.0);
        vec4 b = projection * view * model * vec4(to, 1.0);
        vec2 pa = a.xy / a.w * screen, pb = b.xy / b.w * screen;
        vec2 way = pb - pa;
        float length2 = dot(way, way);
        way = length2 > 1e-8 ? way * inversesqrt(length2) : vec2(1, 0);
        vec2 side = vec2(-way.y, way.x) * corner.y + way * (corner.x * 2.0 - 1.0);
        vec4 end = corner.x < 0.5 ? a : b;
        along = corner.x;
        gl_Position = end + vec4(side * width / screen * end.w, 0.0, 0.0);
      }`,
    fragment: `#version 300 es
      precision mediump float;
      in float along;
      uniform vec4 colour;
      out vec4 shown;
      void main() { shown = vec4(colour.rgb * colour.a, colour.a); }`,
  },
};
