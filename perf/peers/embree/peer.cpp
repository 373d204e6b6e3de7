// Traces the rays of an octray dump with Embree 3 or 4, in every mode that may be its fastest, and compares
// the hits with octray's. Compile it once for each version, with -DEMBREE=3 or -DEMBREE=4.
//
//   peer DUMP [--passes N] [--only MODE]... [--json]     trace: Mray/s of each mode, agreement with octray
//   peer DUMP --builds [--passes N] [--json]             build only: milliseconds of each scene, on one thread and on all
//
// A mode is embreeN/QUALITY/ROBUSTNESS/CALL/FLAG, such as embree4/high/fast/packet8/coherent. Tracing runs on
// the calling thread alone.
//
// What is timed: one pass of rtcIntersect* (closest hit: primary, diffuse) or rtcOccluded* (any hit: shadow)
// over all rays of a kind, which are stored in the layout of the call. Filling that layout, resetting it
// between passes and reading the hits out of it are not timed, as octray's arrays are not.

#include "dump.h"
#include "reference.h"
#include "versions.h"

#include <pmmintrin.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <map>
#include <memory>
#include <sstream>
#include <thread>

static double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

static double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    size_t n = values.size();
    return n % 2 ? values[n / 2] : (values[n / 2 - 1] + values[n / 2]) / 2;
}

// ---------------------------------------------------------------------------------------------------------------- scenes

static const std::map<std::string, RTCBuildQuality> QUALITIES = {
    {"low", RTC_BUILD_QUALITY_LOW}, {"medium", RTC_BUILD_QUALITY_MEDIUM}, {"high", RTC_BUILD_QUALITY_HIGH}};

// The mesh as Embree's users store it: shared vertices, three indices per triangle.
struct Mesh {
    std::vector<std::array<float, 3>> vertices;
    std::vector<std::array<uint32_t, 3>> indices;

    explicit Mesh(const std::vector<Triangle>& triangles) : indices(triangles.size()) {
        std::map<std::array<float, 3>, uint32_t> known;
        for (size_t i = 0; i < triangles.size(); i++)
            for (int corner = 0; corner < 3; corner++) {
                auto [found, fresh] = known.try_emplace(triangles[i][corner], static_cast<uint32_t>(vertices.size()));
                if (fresh) vertices.push_back(triangles[i][corner]);
                indices[i][corner] = found->second;
            }
        vertices.push_back({}); // Embree loads the last vertex with 16 bytes
    }
};

class Device {
public:
    explicit Device(unsigned threads) : handle(rtcNewDevice(("threads=" + std::to_string(threads)).c_str())) {
        if (!handle) throw std::runtime_error("Embree gives no device");
        if (property(RTC_DEVICE_PROPERTY_VERSION_MAJOR) != EMBREE) throw std::runtime_error("the library is another version of Embree");
    }
    ~Device() { rtcReleaseDevice(handle); }
    Device(const Device&) = delete;
    long property(RTCDeviceProperty property) const { return static_cast<long>(rtcGetDeviceProperty(handle, property)); }
    RTCDevice handle;
};

class Scene {
public:
    Scene(const Device& device, const Mesh& mesh, const std::string& quality, bool robust) : handle(rtcNewScene(device.handle)) {
        RTCGeometry geometry = rtcNewGeometry(device.handle, RTC_GEOMETRY_TYPE_TRIANGLE);
        rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, mesh.vertices.data(), 0, 12,
                                   mesh.vertices.size() - 1);
        rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.indices.data(), 0, 12,
                                   mesh.indices.size());
        rtcCommitGeometry(geometry);
        rtcAttachGeometryByID(handle, geometry, 0);
        rtcReleaseGeometry(geometry);
        rtcSetSceneBuildQuality(handle, QUALITIES.at(quality));
        rtcSetSceneFlags(handle, robust ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE);
        auto start = std::chrono::steady_clock::now();
        rtcCommitScene(handle);
        build_seconds = seconds_since(start);
        if (rtcGetDeviceError(device.handle) != RTC_ERROR_NONE) throw std::runtime_error("Embree does not build this scene");
    }
    ~Scene() { rtcReleaseScene(handle); }
    Scene(const Scene&) = delete;
    RTCScene handle;
    double build_seconds;
};

// --------------------------------------------------------------------------------------------------------------- calls

// All rays of a kind, laid out for one of Embree's calls.
struct Batch {
    virtual ~Batch() = default;
    virtual void reset() = 0;
    virtual void trace(RTCScene scene, Query& query) = 0;
    virtual Answers answers() = 0;
};

template <int N> struct Layout;
template <> struct Layout<1> { using Ray = RTCRay; using RayHit = RTCRayHit; };
template <> struct Layout<8> { using Ray = RTCRay8; using RayHit = RTCRayHit8; };
template <> struct Layout<16> { using Ray = RTCRay16; using RayHit = RTCRayHit16; };

// rtcIntersect1/8/16 and rtcOccluded1/8/16.
template <int N, bool ANY> class Packets : public Batch {
    using Packet = std::conditional_t<ANY, typename Layout<N>::Ray, typename Layout<N>::RayHit>;

public:
    explicit Packets(const Rays& rays) : count(rays.count), fresh((rays.count + N - 1) / N), packets(fresh.size()) {
        for (size_t i = 0; i < fresh.size() * N; i++) {
            size_t from = std::min(i, count - 1); // lanes beyond the end hold a ray and are masked out
            RTCRayN* ray = ray_of(fresh[i / N]);
            unsigned lane = i % N;
            RTCRayN_org_x(ray, N, lane) = rays.origin[0][from];
            RTCRayN_org_y(ray, N, lane) = rays.origin[1][from];
            RTCRayN_org_z(ray, N, lane) = rays.origin[2][from];
            RTCRayN_dir_x(ray, N, lane) = rays.direction[0][from];
            RTCRayN_dir_y(ray, N, lane) = rays.direction[1][from];
            RTCRayN_dir_z(ray, N, lane) = rays.direction[2][from];
            RTCRayN_tnear(ray, N, lane) = 0;
            RTCRayN_tfar(ray, N, lane) = rays.t_max[from];
            RTCRayN_time(ray, N, lane) = 0;
            RTCRayN_mask(ray, N, lane) = ~0u;
            RTCRayN_id(ray, N, lane) = 0;
            RTCRayN_flags(ray, N, lane) = 0;
            if constexpr (!ANY) {
                RTCHitN* hit = hit_of(fresh[i / N]);
                RTCHitN_geomID(hit, N, lane) = RTC_INVALID_GEOMETRY_ID;
                RTCHitN_primID(hit, N, lane) = RTC_INVALID_GEOMETRY_ID;
                set_no_instance(hit, N, lane);
            }
        }
    }

    void reset() override { packets = fresh; }

    void trace(RTCScene scene, Query& query) override {
        alignas(64) int valid[N];
        std::fill(valid, valid + N, -1);
        size_t whole = count / N;
        for (size_t i = 0; i < whole; i++) call(valid, scene, query, packets[i]);
        if (count % N) {
            std::fill(valid + count % N, valid + N, 0);
            call(valid, scene, query, packets[whole]);
        }
    }

    Answers answers() override {
        Answers answers(count);
        for (size_t i = 0; i < count; i++) {
            float t = RTCRayN_tfar(ray_of(packets[i / N]), N, i % N);
            if constexpr (ANY) {
                // A blocked ray's tfar becomes −inf: Embree says that there is a hit, not which.
                if (t < 0) answers.primitive[i] = 0;
            } else if (RTCHitN_geomID(hit_of(packets[i / N]), N, i % N) != RTC_INVALID_GEOMETRY_ID) {
                answers.t[i] = t;
                answers.primitive[i] = RTCHitN_primID(hit_of(packets[i / N]), N, i % N);
            }
        }
        return answers;
    }

private:
    static RTCRayN* ray_of(Packet& packet) { return reinterpret_cast<RTCRayN*>(&packet); }
    static RTCHitN* hit_of(Packet& packet) { return RTCRayHitN_HitN(reinterpret_cast<RTCRayHitN*>(&packet), N); }

    size_t count;
    std::vector<Packet> fresh, packets;
};

#if EMBREE == 3
// rtcIntersectNp and rtcOccludedNp: columns as octray holds them, given in one call. Embree 4 has no streams.
class Stream : public Batch {
public:
    explicit Stream(const Rays& rays)
        : rays(rays), t(rays.count), u(rays.count), v(rays.count), primitive(rays.count), geometry(rays.count) {}

    void reset() override {
        t = rays.t_max;
        std::fill(geometry.begin(), geometry.end(), RTC_INVALID_GEOMETRY_ID);
    }

    void trace(RTCScene scene, Query& query) override {
        RTCRayHitNp columns{}; // what is null, Embree takes for its default or leaves unwritten
        auto of = [](const std::vector<float>& column) { return const_cast<float*>(column.data()); };
        columns.ray.org_x = of(rays.origin[0]);
        columns.ray.org_y = of(rays.origin[1]);
        columns.ray.org_z = of(rays.origin[2]);
        columns.ray.dir_x = of(rays.direction[0]);
        columns.ray.dir_y = of(rays.direction[1]);
        columns.ray.dir_z = of(rays.direction[2]);
        columns.ray.tfar = t.data();
        columns.hit.u = u.data();
        columns.hit.v = v.data();
        columns.hit.primID = primitive.data();
        columns.hit.geomID = geometry.data();
        auto count = static_cast<unsigned>(rays.count);
        if (rays.any_hit) rtcOccludedNp(scene, &query.context, &columns.ray, count);
        else rtcIntersectNp(scene, &query.context, &columns, count);
    }

    Answers answers() override {
        Answers answers(rays.count);
        for (size_t i = 0; i < rays.count; i++) {
            if (rays.any_hit) {
                if (t[i] < 0) answers.primitive[i] = 0;
            } else if (geometry[i] != RTC_INVALID_GEOMETRY_ID) {
                answers.t[i] = t[i];
                answers.primitive[i] = primitive[i];
            }
        }
        return answers;
    }

private:
    const Rays& rays;
    std::vector<float> t, u, v;
    std::vector<unsigned> primitive, geometry;
};
#endif

template <bool ANY> static std::unique_ptr<Batch> batch_of(const std::string& call, const Rays& rays) {
    if (call == "single") return std::make_unique<Packets<1, ANY>>(rays);
    if (call == "packet8") return std::make_unique<Packets<8, ANY>>(rays);
#if EMBREE == 3
    if (call == "stream") return std::make_unique<Stream>(rays);
#endif
    return std::make_unique<Packets<16, ANY>>(rays);
}

// --------------------------------------------------------------------------------------------------------------- modes

struct Mode {
    std::string quality, call;
    bool robust, coherent;

    std::string name() const {
        return "embree" + std::to_string(EMBREE) + "/" + quality + (robust ? "/robust/" : "/fast/") + call + (coherent ? "/coherent" : "/incoherent");
    }
};

static std::vector<Mode> all_modes() {
    std::vector<const char*> calls = {"single", "packet8", "packet16"};
    if (EMBREE == 3) calls.push_back("stream");
    std::vector<Mode> modes;
    // LOW took as long to build as MEDIUM and traced no faster in any mode: only its builds are measured.
    for (const char* quality : {"medium", "high"})
        for (bool robust : {false, true})
            for (const char* call : calls)
                for (bool coherent : {false, true}) modes.push_back({quality, call, robust, coherent});
    return modes;
}

struct Result {
    std::string kind;
    Mode mode;
    size_t rays, hits;
    std::vector<double> mrays; // one value per pass
    Agreement agreement;
};

static Result trace(const Scene& scene, const Rays& rays, const Mode& mode, int passes, const std::vector<Triangle>& triangles) {
    auto batch = rays.any_hit ? batch_of<true>(mode.call, rays) : batch_of<false>(mode.call, rays);
    Query query(mode.coherent);

    Result result{rays.kind, mode, rays.count, 0, {}, {}};
    for (int pass = 0; pass <= passes; pass++) {
        batch->reset();
        auto start = std::chrono::steady_clock::now();
        batch->trace(scene.handle, query);
        double seconds = seconds_since(start);
        if (pass > 0) result.mrays.push_back(rays.count / seconds * 1e-6); // the first pass warms up
    }
    Answers answers = batch->answers();
    result.hits = answers.hits();
    // Only the robust mode promises watertight hits: its differences are held against the reference, those of
    // fast modes counted.
    result.agreement = compare(rays, answers, triangles, mode.robust);
    return result;
}

struct Build {
    std::string quality;
    bool robust;
    unsigned threads;
    std::vector<double> milliseconds;
};

static std::vector<Build> builds(const Mesh& mesh, int passes) {
    std::vector<Build> builds;
    unsigned all = std::max(1u, std::thread::hardware_concurrency());
    for (unsigned threads : all > 1 ? std::vector<unsigned>{1, all} : std::vector<unsigned>{1}) {
        Device device(threads);
        for (const char* quality : {"low", "medium", "high"})
            for (bool robust : {false, true}) {
                Build build{quality, robust, threads, {}};
                for (int pass = 0; pass <= passes; pass++) {
                    Scene scene(device, mesh, quality, robust);
                    if (pass > 0) build.milliseconds.push_back(scene.build_seconds * 1e3);
                }
                builds.push_back(build);
            }
    }
    return builds;
}

// -------------------------------------------------------------------------------------------------------------- report

static std::string spread(const std::vector<double>& values) {
    char text[96];
    auto [low, high] = std::minmax_element(values.begin(), values.end());
    std::snprintf(text, sizeof text, "{\"median\":%.4f,\"min\":%.4f,\"max\":%.4f}", median(values), *low, *high);
    return text;
}

static std::string json(const Agreement& a) {
    std::ostringstream out;
    out << "{\"lost_by_octray\":" << a.lost_by_octray << ",\"lost_by_embree\":" << a.lost_by_embree
        << ",\"other_t\":" << a.other_t << ",\"other_primitive\":" << a.other_primitive << ",\"ties\":" << a.ties;
    if (a.is_judged)
        out << ",\"judged\":{\"rays\":" << a.judged << ",\"octray_right\":" << a.octray_right
            << ",\"embree_right\":" << a.embree_right << ",\"within_bound\":" << a.within_bound
            << ",\"within_bound_exact_octray\":" << a.exact_octray << ",\"within_bound_exact_embree\":" << a.exact_embree
            << ",\"both_wrong\":" << a.both_wrong << "}";
    out << "}";
    return out.str();
}

static void print(const std::vector<Result>& results) {
    std::printf("%-8s %-42s %8s %17s %9s %9s   %s\n", "kind", "mode", "Mray/s", "min..max", "rays", "hits",
                "disagreements (octray right / Embree right / within bound / both wrong)");
    for (const Result& r : results) {
        auto [low, high] = std::minmax_element(r.mrays.begin(), r.mrays.end());
        const Agreement& a = r.agreement;
        std::printf("%-8s %-42s %8.2f %8.2f..%7.2f %9zu %9zu   %zu", r.kind.c_str(), r.mode.name().c_str(), median(r.mrays), *low,
                    *high, r.rays, r.hits, a.disagreements());
        if (a.is_judged) std::printf(" (%zu / %zu / %zu / %zu)", a.octray_right, a.embree_right, a.within_bound, a.both_wrong);
        std::printf("\n");
        for (const std::string& line : a.examples) std::printf("         %s\n", line.c_str());
    }
}

struct Options {
    std::string folder;
    int passes = 7;
    std::vector<std::string> only;
    bool json = false, builds = false;
};

static Options parse(int argc, char** argv) {
    Options options;
    for (int i = 1; i < argc; i++) {
        std::string word = argv[i];
        auto value = [&] {
            if (++i == argc) throw std::runtime_error(word + " needs a value");
            return std::string(argv[i]);
        };
        if (word == "--passes") options.passes = std::max(1, std::atoi(value().c_str()));
        else if (word == "--only") options.only.push_back(value());
        else if (word == "--json") options.json = true;
        else if (word == "--builds") options.builds = true;
        else if (word[0] == '-' || !options.folder.empty()) throw std::runtime_error("unknown option " + word);
        else options.folder = word;
    }
    if (options.folder.empty()) throw std::runtime_error("usage: peer DUMP [--passes N] [--only MODE]... [--builds] [--json]");
    return options;
}

static int run(const Options& options) {
    auto triangles = dump::triangles(options.folder);
    if (triangles.empty()) throw std::runtime_error(options.folder + ": there are no triangles to trace");
    Mesh mesh(triangles);

    if (options.builds) {
        auto all = builds(mesh, options.passes);
        if (options.json) std::printf("{\"schema\":\"octray-embree-builds-1\",\"triangles\":%zu,\"builds\":[", triangles.size());
        for (const Build& b : all) {
            const char* robustness = b.robust ? "robust" : "fast";
            if (options.json)
                std::printf("%s\n{\"quality\":\"%s\",\"robustness\":\"%s\",\"threads\":%u,\"ms\":%s}", &b == &all[0] ? "" : ",",
                            b.quality.c_str(), robustness, b.threads, spread(b.milliseconds).c_str());
            else
                std::printf("build %-6s %-6s %3u threads %9.2f ms\n", b.quality.c_str(), robustness, b.threads,
                            median(b.milliseconds));
        }
        if (options.json) std::printf("\n]}\n");
        return 0;
    }

    // As Embree's manual recommends for every thread that traces.
    _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
    _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);

    Device device(1);
    std::vector<Rays> kinds;
    for (const char* kind : {"primary", "shadow", "diffuse"}) kinds.push_back(dump::rays(options.folder, kind));
    std::map<std::pair<std::string, bool>, std::unique_ptr<Scene>> scenes;
    std::vector<Result> results;
    for (const Rays& rays : kinds)
        for (const Mode& mode : all_modes()) {
            bool wanted = options.only.empty() || std::count(options.only.begin(), options.only.end(), mode.name());
            if (!wanted || rays.count == 0) continue;
            auto& scene = scenes[{mode.quality, mode.robust}];
            if (!scene) scene = std::make_unique<Scene>(device, mesh, mode.quality, mode.robust);
            results.push_back(trace(*scene, rays, mode, options.passes, triangles));
        }
    if (!options.json) {
        print(results);
        return 0;
    }
    std::printf("{\"schema\":\"octray-embree-2\",\"embree\":\"%ld.%ld.%ld\",\"native_packet8\":%s,\"native_packet16\":%s,"
                "\"triangles\":%zu,\"results\":[",
                device.property(RTC_DEVICE_PROPERTY_VERSION_MAJOR), device.property(RTC_DEVICE_PROPERTY_VERSION_MINOR),
                device.property(RTC_DEVICE_PROPERTY_VERSION_PATCH),
                device.property(RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED) ? "true" : "false",
                device.property(RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED) ? "true" : "false", triangles.size());
    for (const Result& r : results)
        std::printf("%s\n{\"kind\":\"%s\",\"mode\":\"%s\",\"rays\":%zu,\"hits\":%zu,\"mrays_per_s\":%s,\"agreement\":%s}",
                    &r == &results[0] ? "" : ",", r.kind.c_str(), r.mode.name().c_str(), r.rays, r.hits, spread(r.mrays).c_str(),
                    json(r.agreement).c_str());
    std::printf("\n]}\n");
    return 0;
}

int main(int argc, char** argv) {
    try {
        return run(parse(argc, argv));
    } catch (const std::exception& error) {
        std::fprintf(stderr, "peer: %s\n", error.what());
        return 2;
    }
}
