// Embree on one thread, on a mesh from a file: what versus/run.py puts beside rtscript.
//
//   g++ -O3 -march=native embree.cpp -lembree3 -o embree
//   embree MESH.rtsm RAYDIR [--quality medium|high] [--robust] [--reps N] [--write-rays | --build-only]
//
// Prints comma-separated values: "build", seconds, bytes per triangle, triangles; then for each set of rays its name,
// million rays per processor second (median of N after one to warm up), hits, rays. With --write-rays it makes the
// rays of the sets and writes them to RAYDIR: pinhole camera rays in Morton order within tiles of 8 by 8; from each
// point they hit one ray into the hemisphere by the cosine, and one to a point light.

#include <embree3/rtcore.h>

#include <time.h>
#include <xmmintrin.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <string>
#include <vector>

namespace {

struct Vec {
  float x, y, z;
};

Vec operator+(Vec a, Vec b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
Vec operator-(Vec a, Vec b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Vec operator*(Vec a, float s) { return {a.x * s, a.y * s, a.z * s}; }
float dot(Vec a, Vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Vec cross(Vec a, Vec b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
Vec unit(Vec a) { return a * (1 / std::sqrt(dot(a, a))); }

// As in the files: 32 bytes.
struct Ray {
  Vec origin;
  float t_min;
  Vec dir;
  float t_max;
};

struct View {
  Vec eye, target, up;
  float angle;
  Vec light;
  float unused[3];
};

struct Mesh {
  View view;
  std::vector<Vec> vertices;
  std::vector<uint32_t> corners;
};

[[noreturn]] void fail(const std::string& what) {
  std::fprintf(stderr, "embree: %s\n", what.c_str());
  std::exit(1);
}

double cpu_seconds() {
  timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return t.tv_sec + 1e-9 * t.tv_nsec;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

Mesh read_mesh(const std::string& path) {
  FILE* file = std::fopen(path.c_str(), "rb");
  if (!file) fail("cannot open " + path);
  char letters[4];
  uint32_t counts[2];
  Mesh mesh;
  bool ok = std::fread(letters, 4, 1, file) == 1 && std::fread(counts, 8, 1, file) == 1 &&
            std::fread(&mesh.view, sizeof(View), 1, file) == 1;
  if (ok) {
    // One vertex more than there are: Embree reads 16 bytes at each.
    mesh.vertices.resize(counts[0] + 1);
    mesh.corners.resize(3 * size_t(counts[1]));
    ok = std::fread(mesh.vertices.data(), sizeof(Vec), counts[0], file) == counts[0] &&
         std::fread(mesh.corners.data(), 12, counts[1], file) == counts[1];
  }
  std::fclose(file);
  if (!ok) fail("cannot read " + path);
  return mesh;
}

std::vector<Ray> read_rays(const std::string& path) {
  FILE* file = std::fopen(path.c_str(), "rb");
  if (!file) fail("cannot open " + path);
  std::fseek(file, 0, SEEK_END);
  std::vector<Ray> rays(std::ftell(file) / sizeof(Ray));
  std::rewind(file);
  if (std::fread(rays.data(), sizeof(Ray), rays.size(), file) != rays.size()) fail("cannot read " + path);
  std::fclose(file);
  return rays;
}

void write_rays(const std::string& path, const std::vector<Ray>& rays) {
  FILE* file = std::fopen(path.c_str(), "wb");
  if (!file || std::fwrite(rays.data(), sizeof(Ray), rays.size(), file) != rays.size()) fail("cannot write " + path);
  std::fclose(file);
}

long bytes_held = 0;

bool count_bytes(void*, ssize_t bytes, bool) {
  bytes_held += bytes;
  return true;
}

RTCScene build(RTCDevice device, const Mesh& mesh, RTCBuildQuality quality, bool robust) {
  RTCScene scene = rtcNewScene(device);
  rtcSetSceneBuildQuality(scene, quality);
  rtcSetSceneFlags(scene, robust ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE);
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetGeometryBuildQuality(geometry, quality);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, mesh.vertices.data(), 0, 12,
                             mesh.vertices.size() - 1);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.corners.data(), 0, 12,
                             mesh.corners.size() / 3);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene);
  return scene;
}

RTCRayHit prepared(const Ray& ray) {
  RTCRayHit r;
  r.ray = {ray.origin.x, ray.origin.y, ray.origin.z, ray.t_min, ray.dir.x, ray.dir.y, ray.dir.z, 0, ray.t_max,
           ~0u,          0,            0};
  r.hit.geomID = r.hit.primID = r.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  return r;
}

bool nearest(RTCScene scene, RTCRayHit& r) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(scene, &context, &r);
  return r.hit.geomID != RTC_INVALID_GEOMETRY_ID;
}

bool occluded(RTCScene scene, const Ray& ray) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRayHit r = prepared(ray);
  rtcOccluded1(scene, &context, &r.ray);
  return r.ray.tfar < 0;
}

uint32_t hash(uint32_t x) {  // O'Neill's PCG, one step
  x = x * 747796405u + 2891336453u;
  const uint32_t word = ((x >> ((x >> 28) + 4)) ^ x) * 277803737u;
  return (word >> 22) ^ word;
}

float random(uint32_t i, uint32_t dimension) { return (hash(i * 2 + hash(dimension)) >> 8) * (1.0f / 16777216.0f); }

struct Sets {
  std::vector<Ray> primary, ao, shadow;
};

Sets make_rays(RTCScene scene, const View& view) {
  constexpr int size = 1024;
  constexpr float infinity = std::numeric_limits<float>::infinity();
  constexpr float pi = 3.14159265f;
  Sets sets;
  const Vec forward = unit(view.target - view.eye), right = unit(cross(forward, view.up)), up = cross(right, forward);
  const float half = std::tan(view.angle * 0.5f * pi / 180);
  for (int ty = 0; ty < size; ty += 8)
    for (int tx = 0; tx < size; tx += 8)
      for (int m = 0; m < 64; m++) {
        const int x = tx + ((m & 1) | (m >> 1 & 2) | (m >> 2 & 4)), y = ty + ((m >> 1 & 1) | (m >> 2 & 2) | (m >> 3 & 4));
        const float sx = (2 * (x + 0.5f) / size - 1) * half, sy = (1 - 2 * (y + 0.5f) / size) * half;
        sets.primary.push_back({view.eye, 0, unit(forward + right * sx + up * sy), infinity});
      }
  uint32_t i = 0;
  for (const Ray& ray : sets.primary) {
    RTCRayHit r = prepared(ray);
    i++;
    if (!nearest(scene, r)) continue;
    Vec n = unit({r.hit.Ng_x, r.hit.Ng_y, r.hit.Ng_z});
    if (dot(n, ray.dir) > 0) n = n * -1;
    const Vec p = ray.origin + ray.dir * r.ray.tfar + n * (1e-4f * r.ray.tfar);
    const float u = random(i, 1), angle = 2 * pi * random(i, 2), sine = std::sqrt(u), cosine = std::sqrt(1 - u);
    const Vec s = unit(cross(std::fabs(n.x) > 0.9f ? Vec{0, 1, 0} : Vec{1, 0, 0}, n)), t = cross(n, s);
    const Vec dir = unit(s * (sine * std::cos(angle)) + t * (sine * std::sin(angle)) + n * cosine);
    sets.ao.push_back({p, 0, dir, infinity});
    sets.shadow.push_back({p, 0, view.light - p, 0.9999f});
  }
  return sets;
}

template <class Hit>
void measure(const char* name, const std::vector<Ray>& rays, int reps, Hit hit) {
  std::vector<double> rates;
  size_t hits = 0;
  for (int rep = 0; rep <= reps; rep++) {
    const double start = cpu_seconds();
    hits = std::count_if(rays.begin(), rays.end(), hit);
    if (rep) rates.push_back(rays.size() / (cpu_seconds() - start) * 1e-6);
  }
  std::printf("%s,%.3f,%zu,%zu\n", name, median(rates), hits, rays.size());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) fail("usage: embree MESH.rtsm RAYDIR [--quality medium|high] [--robust] [--reps N] [--write-rays | --build-only]");
  const std::string path = argv[1], dir = argv[2];
  RTCBuildQuality quality = RTC_BUILD_QUALITY_MEDIUM;
  bool robust = false, write = false, build_only = false;
  int reps = 3;
  for (int i = 3; i < argc; i++) {
    const std::string option = argv[i];
    if (option == "--robust") robust = true;
    else if (option == "--write-rays") write = true;
    else if (option == "--build-only") build_only = true;
    else if (option == "--reps" && i + 1 < argc) reps = std::atoi(argv[++i]);
    else if (option == "--quality" && i + 1 < argc) quality = argv[++i][0] == 'h' ? RTC_BUILD_QUALITY_HIGH : RTC_BUILD_QUALITY_MEDIUM;
    else fail("what is " + option + "?");
  }
  _mm_setcsr(_mm_getcsr() | 0x8040);  // denormals are zero, as Embree's manual asks
  const Mesh mesh = read_mesh(path);
  const size_t slash = path.find_last_of('/'), triangles = mesh.corners.size() / 3;
  const std::string name = path.substr(slash + 1, path.rfind(".rtsm") - slash - 1);
  RTCDevice device = rtcNewDevice("threads=1");
  rtcSetDeviceMemoryMonitorFunction(device, count_bytes, nullptr);
  RTCScene scene = nullptr;
  std::vector<double> times;
  for (int i = 0; i < reps; i++) {
    if (scene) rtcReleaseScene(scene);
    bytes_held = 0;
    const double start = cpu_seconds();
    scene = build(device, mesh, quality, robust);
    times.push_back(cpu_seconds() - start);
  }
  std::printf("build,%.6f,%.1f,%zu\n", median(times), double(bytes_held) / triangles, triangles);
  if (build_only) return 0;
  if (write) {
    const Sets sets = make_rays(scene, mesh.view);
    write_rays(dir + "/" + name + ".primary.rays", sets.primary);
    write_rays(dir + "/" + name + ".ao.rays", sets.ao);
    write_rays(dir + "/" + name + ".shadow.rays", sets.shadow);
    return 0;
  }
  const auto closest = [scene](const Ray& ray) {
    RTCRayHit r = prepared(ray);
    return nearest(scene, r);
  };
  const auto any = [scene](const Ray& ray) { return occluded(scene, ray); };
  const auto rays = [&](const char* set) { return read_rays(dir + "/" + name + "." + set + ".rays"); };
  const std::vector<Ray> ao = rays("ao");
  measure("primary", rays("primary"), reps, closest);
  measure("ao", ao, reps, closest);
  measure("ao-any", ao, reps, any);
  measure("shadow", rays("shadow"), reps, any);
  return 0;
}
