// Rendering on the CPU with OSMesa. The fragment shader writes which triangle is seen and z as a
// float, so nothing is lost to a depth buffer's scale; the depth buffer only decides which triangle
// is in front. Normals are looked up afterwards: a wider frame buffer halves the speed, for most of
// the time goes into clearing, writing and reading its bytes.
#define GL_GLEXT_PROTOTYPES 1
#include "binpick/train/renderer.hpp"

#include <GL/osmesa.h>
// osmesa.h brings gl.h; glext.h has what came after OpenGL 1.3.
#include <GL/glext.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <mutex>
#include <string>

#include "binpick/base/assert.hpp"
#include "binpick/train/errors.hpp"

namespace binpick::train {
namespace {

// Row 0 of the frame buffer holds the top row of the image: rows never have to be exchanged.
constexpr const char* kVertexShader = R"(#version 330 core
layout(location = 0) in vec3 x_obj;
uniform mat4 T_clip_obj;
void main() { gl_Position = T_clip_obj * vec4(x_obj, 1.0); }
)";

// clip.w is z in mm, therefore gl_FragCoord.w is 1 / z. Triangle 0 is written as 1, since 0 means
// none; floats count exactly up to 2^24.
constexpr const char* kFragmentShader = R"(#version 330 core
layout(location = 0) out vec2 triangle_and_depth;
void main() { triangle_and_depth = vec2(float(gl_PrimitiveID + 1), 1.0 / gl_FragCoord.w); }
)";
constexpr std::size_t kTrianglesMax = std::size_t{1} << 24;

// What comes closer to the plane of the camera than this is cut away.
constexpr double kNearMin_mm = 1.0;
constexpr int kTargetSizeMin = 64;  // one tile of the rasteriser

// A piece of the image, in pixels.
struct Region {
  int x = 0, y = 0, width = 0, height = 0;
};

struct ViewBounds {
  Region region;
  double near_mm = 0, far_mm = 0;
  bool empty() const { return region.width <= 0 || region.height <= 0; }
};

// OSMesa's first context reads the environment: with no threads of its own, rasterising happens on
// the caller's thread, which is faster for small images and leaves the cores to the trainer;
// without the shader cache it starts no writer thread and leaves nothing in the user's home. Making
// and destroying contexts touches state that they share, hence the lock.
std::mutex& context_mutex() {
  static std::mutex mutex;
  static std::once_flag once;
  std::call_once(once, [] {
    setenv("LP_NUM_THREADS", "0", 1);
    setenv("MESA_SHADER_CACHE_DISABLE", "true", 1);
  });
  return mutex;
}

GLuint compile_stage(GLenum stage, const char* source) {
  const GLuint shader = glCreateShader(stage);
  glShaderSource(shader, 1, &source, nullptr);
  glCompileShader(shader);
  GLint ok = GL_FALSE;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &ok);
  if (ok != GL_TRUE) {
    char log[512] = "";
    glGetShaderInfoLog(shader, sizeof log, nullptr, log);
    throw RenderError(std::string("the off-screen renderer refuses its shader: ") + log);
  }
  return shader;
}

// From 0 in pixels up to and including the last one; clamped before the conversion, which would
// overflow.
int clamp_pixel(double value, int size) {
  return static_cast<int>(std::clamp(value, 0.0, double(size)));
}

}  // namespace

struct Renderer::Impl {
  Impl(const Mesh& mesh, int width_max, int height_max);
  ~Impl();

  // The context is bound for the time of a call only, so that a renderer may be made on one thread
  // and used or destroyed on another without leaving a dangling current context behind.
  struct Binding {
    explicit Binding(Impl& impl) {
      if (OSMesaMakeCurrent(impl.context, impl.window, GL_UNSIGNED_BYTE, 1, 1) != GL_TRUE) {
        throw RenderError("the off-screen OpenGL context cannot be made current");
      }
    }
    ~Binding() { OSMesaMakeCurrent(nullptr, nullptr, GL_UNSIGNED_BYTE, 0, 0); }
    Binding(const Binding&) = delete;
    Binding& operator=(const Binding&) = delete;
  };

  void take_mesh(const Mesh& mesh);
  void make_program();
  void upload_mesh();
  void fit_target(int width, int height);
  ViewBounds bounds_of_view(const CameraIntrinsics& camera, const Pose& T_cam_obj) const;
  void set_view(const CameraIntrinsics& camera, const Pose& T_cam_obj,
                const ViewBounds& bounds) const;
  void draw_and_read(const CameraIntrinsics& camera, const Pose& T_cam_obj,
                     const ViewBounds& bounds);
  void shade_region(const CameraIntrinsics& camera, const Pose& T_cam_obj, const Region& region,
                    RenderedView& out) const;

  int width_max, height_max;
  std::vector<Eigen::Vector3f> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;  // without those of zero area
  std::vector<Eigen::Vector3f> face_normals;            // one a triangle, in object axes
  std::vector<Eigen::Vector2f> pixels;                  // what was read back: triangle and z

  OSMesaContext context = nullptr;
  unsigned char window[4] = {};  // OSMesa wants a window; all drawing goes to a frame buffer object
  GLuint framebuffer = 0, color_target = 0, depth_target = 0;
  int target_width = 0, target_height = 0;
  GLint clip_location = -1;
};

Renderer::Impl::Impl(const Mesh& mesh, int width, int height)
    : width_max(width), height_max(height) {
  BINPICK_ASSERT(width > 0 && height > 0);
  take_mesh(mesh);
  const std::lock_guard lock(context_mutex());
  const int attributes[] = {OSMESA_FORMAT,
                            OSMESA_RGBA,
                            OSMESA_DEPTH_BITS,
                            0,
                            OSMESA_PROFILE,
                            OSMESA_CORE_PROFILE,
                            OSMESA_CONTEXT_MAJOR_VERSION,
                            3,
                            OSMESA_CONTEXT_MINOR_VERSION,
                            3,
                            0};
  context = OSMesaCreateContextAttribs(attributes, nullptr);
  if (context == nullptr) {
    throw RenderError("no off-screen OpenGL 3.3 context: is libOSMesa complete on this machine?");
  }
  try {
    const Binding binding(*this);
    make_program();
    upload_mesh();
    fit_target(std::min(width, kTargetSizeMin), std::min(height, kTargetSizeMin));
  } catch (...) {
    OSMesaDestroyContext(context);
    throw;
  }
}

// Everything made in a context goes with it.
Renderer::Impl::~Impl() {
  const std::lock_guard lock(context_mutex());
  OSMesaDestroyContext(context);
}

void Renderer::Impl::take_mesh(const Mesh& mesh) {
  vertices = mesh.vertices_mm;
  for (const auto& triangle : mesh.triangles) {
    if (std::any_of(triangle.begin(), triangle.end(),
                    [&](auto i) { return i >= vertices.size(); })) {
      throw RenderError("a triangle of the mesh refers to a vertex that does not exist");
    }
    const Vec3 a = vertices[triangle[0]].cast<double>();
    const Vec3 n =
        (vertices[triangle[1]].cast<double>() - a).cross(vertices[triangle[2]].cast<double>() - a);
    if (!(n.norm() > 0)) continue;
    triangles.push_back(triangle);
    face_normals.push_back(n.normalized().cast<float>());
  }
  if (triangles.empty()) throw RenderError("the mesh has no triangle that could be drawn");
  if (triangles.size() >= kTrianglesMax) {
    throw RenderError("the mesh has more triangles than the off-screen renderer can number");
  }
}

void Renderer::Impl::make_program() {
  const GLuint program = glCreateProgram();
  glAttachShader(program, compile_stage(GL_VERTEX_SHADER, kVertexShader));
  glAttachShader(program, compile_stage(GL_FRAGMENT_SHADER, kFragmentShader));
  glLinkProgram(program);
  GLint ok = GL_FALSE;
  glGetProgramiv(program, GL_LINK_STATUS, &ok);
  if (ok != GL_TRUE) throw RenderError("the off-screen renderer cannot link its shaders");
  glUseProgram(program);
  clip_location = glGetUniformLocation(program, "T_clip_obj");
}

void Renderer::Impl::upload_mesh() {
  const auto upload = [](GLenum target, const auto& values) {
    GLuint buffer = 0;
    glGenBuffers(1, &buffer);
    glBindBuffer(target, buffer);
    glBufferData(target, static_cast<GLsizeiptr>(values.size() * sizeof(values[0])), values.data(),
                 GL_STATIC_DRAW);
  };
  GLuint vertex_array = 0;
  glGenVertexArrays(1, &vertex_array);
  glBindVertexArray(vertex_array);
  upload(GL_ARRAY_BUFFER, vertices);
  glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(Eigen::Vector3f), nullptr);
  glEnableVertexAttribArray(0);
  upload(GL_ELEMENT_ARRAY_BUFFER, triangles);

  glGenFramebuffers(1, &framebuffer);
  glGenRenderbuffers(1, &color_target);
  glGenRenderbuffers(1, &depth_target);
  glEnable(GL_DEPTH_TEST);
  glDisable(GL_CULL_FACE);
  glDisable(GL_DITHER);
  glClearColor(0, 0, 0, 0);
  if (glGetError() != GL_NO_ERROR) {
    throw RenderError("the off-screen renderer has no memory for the mesh");
  }
}

// Clearing costs as much as the target is large, so the target follows what is drawn, in powers of
// two.
void Renderer::Impl::fit_target(int width, int height) {
  const auto rounded = [](int size) {
    int power = kTargetSizeMin;
    while (power < size) power *= 2;
    return power;
  };
  const int w = rounded(width), h = rounded(height);
  if (w == target_width && h == target_height) return;
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  glBindRenderbuffer(GL_RENDERBUFFER, color_target);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_RG32F, w, h);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, color_target);
  glBindRenderbuffer(GL_RENDERBUFFER, depth_target);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT32F, w, h);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth_target);
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
    throw RenderError("the off-screen renderer has no frame buffer of " + std::to_string(w) +
                      " x " + std::to_string(h) + " float pixels");
  }
  target_width = w;
  target_height = h;
}

// Where in the image the object can appear, from its vertices: an object partly behind the camera
// can appear anywhere.
ViewBounds Renderer::Impl::bounds_of_view(const CameraIntrinsics& camera,
                                          const Pose& T_cam_obj) const {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const Eigen::Matrix3f R = T_cam_obj.R.cast<float>();
  const Eigen::Vector3f t = T_cam_obj.t_mm.cast<float>();
  Eigen::Vector2f low = Eigen::Vector2f::Constant(kInfinity), high = -low;
  float z_min = kInfinity, z_max = -kInfinity;
  for (const Eigen::Vector3f& vertex : vertices) {
    const Eigen::Vector3f x = R * vertex + t;
    z_min = std::min(z_min, x.z());
    z_max = std::max(z_max, x.z());
    const Eigen::Vector2f slope = x.head<2>() / x.z();
    low = low.cwiseMin(slope);
    high = high.cwiseMax(slope);
  }
  ViewBounds bounds;
  if (!(z_max > kNearMin_mm)) return bounds;
  const double margin = 0.01 * (z_max - z_min) + 1e-4 * z_max + 0.01;
  bounds.near_mm = std::max(kNearMin_mm, z_min - margin);
  bounds.far_mm = z_max + margin;
  bounds.region = {0, 0, camera.width, camera.height};
  if (z_min < kNearMin_mm) return bounds;
  const int x0 = clamp_pixel(std::floor(camera.fx * low.x() + camera.cx) - 1, camera.width);
  const int y0 = clamp_pixel(std::floor(camera.fy * low.y() + camera.cy) - 1, camera.height);
  const int x1 = clamp_pixel(std::ceil(camera.fx * high.x() + camera.cx) + 2, camera.width);
  const int y1 = clamp_pixel(std::ceil(camera.fy * high.y() + camera.cy) + 2, camera.height);
  bounds.region = {x0, y0, x1 - x0, y1 - y0};
  return bounds;
}

// Maps the region's pixels to the target's: window x = u + 0.5 - region.x, because OpenGL's pixel
// centres are at halves, and window y likewise without a flip.
void Renderer::Impl::set_view(const CameraIntrinsics& camera, const Pose& T_cam_obj,
                              const ViewBounds& bounds) const {
  const Region& r = bounds.region;
  const double cx = camera.cx + 0.5 - r.x, cy = camera.cy + 0.5 - r.y;
  const double near = bounds.near_mm, far = bounds.far_mm;
  Eigen::Matrix4d projection;
  projection << 2 * camera.fx / r.width, 0, 2 * cx / r.width - 1, 0,      //
      0, 2 * camera.fy / r.height, 2 * cy / r.height - 1, 0,              //
      0, 0, (far + near) / (far - near), -2 * far * near / (far - near),  //
      0, 0, 1, 0;
  Eigen::Matrix4d T = Eigen::Matrix4d::Identity();
  T.topLeftCorner<3, 3>() = T_cam_obj.R;
  T.topRightCorner<3, 1>() = T_cam_obj.t_mm;
  const Eigen::Matrix4f T_clip_obj = (projection * T).cast<float>();
  glUniformMatrix4fv(clip_location, 1, GL_FALSE, T_clip_obj.data());
  glViewport(0, 0, r.width, r.height);
}

void Renderer::Impl::draw_and_read(const CameraIntrinsics& camera, const Pose& T_cam_obj,
                                   const ViewBounds& bounds) {
  const Region& r = bounds.region;
  const Binding binding(*this);
  fit_target(r.width, r.height);
  set_view(camera, T_cam_obj, bounds);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(3 * triangles.size()), GL_UNSIGNED_INT,
                 nullptr);
  pixels.resize(static_cast<std::size_t>(r.width) * static_cast<std::size_t>(r.height));
  glReadPixels(0, 0, r.width, r.height, GL_RG, GL_FLOAT, pixels.data());
  if (glGetError() != GL_NO_ERROR) throw RenderError("the off-screen renderer failed to draw");
}

// The normal is turned against the pixel's ray, for the winding of a file's triangles cannot be
// relied on.
void Renderer::Impl::shade_region(const CameraIntrinsics& camera, const Pose& T_cam_obj,
                                  const Region& region, RenderedView& out) const {
  const Eigen::Matrix3f R = T_cam_obj.R.cast<float>();
  const Eigen::Vector2f* in = pixels.data();
  for (int y = region.y; y < region.y + region.height; ++y) {
    const auto row = static_cast<std::size_t>(y) * static_cast<std::size_t>(out.width);
    const auto ray_y = static_cast<float>((y - camera.cy) / camera.fy);
    for (int x = region.x; x < region.x + region.width; ++x, ++in) {
      if (in->x() == 0.0f) continue;
      const Eigen::Vector3f ray(static_cast<float>((x - camera.cx) / camera.fx), ray_y, 1.0f);
      const Eigen::Vector3f n = R * face_normals[static_cast<std::size_t>(in->x()) - 1];
      const std::size_t i = row + static_cast<std::size_t>(x);
      out.depth_mm[i] = in->y();
      out.normal_cam[i] = n.dot(ray) > 0 ? Eigen::Vector3f(-n) : n;
    }
  }
}

Renderer::Renderer(const Mesh& mesh, int width_max, int height_max)
    : impl_(std::make_unique<Impl>(mesh, width_max, height_max)) {}

Renderer::~Renderer() = default;

void Renderer::render(const CameraIntrinsics& camera, const Pose& T_cam_obj, RenderedView& out) {
  BINPICK_ASSERT(camera.valid() && camera.width > 0 && camera.height > 0);
  BINPICK_ASSERT(camera.width <= impl_->width_max && camera.height <= impl_->height_max);
  const std::size_t count =
      static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height);
  out.width = camera.width;
  out.height = camera.height;
  out.depth_mm.assign(count, 0.0f);
  out.normal_cam.assign(count, Eigen::Vector3f::Zero());
  const ViewBounds bounds = impl_->bounds_of_view(camera, T_cam_obj);
  if (bounds.empty()) return;
  impl_->draw_and_read(camera, T_cam_obj, bounds);
  impl_->shade_region(camera, T_cam_obj, bounds.region, out);
}

}  // namespace binpick::train
