// What peer.cpp uses of Embree 4's interface. PyPI's embreex carries the library without its headers; names,
// values and layouts are those of include/embree4 in github.com/RenderKit/embree, v4.4.0.
//
// The library is built with RTC_GEOMETRY_INSTANCE_ARRAY and one level of instances: hits end with instPrimID.
// In a structure without it, Embree writes past the end.
#pragma once

#include <cstddef>
#include <sys/types.h>

using RTCDevice = struct RTCDeviceTy*;
using RTCScene = struct RTCSceneTy*;
using RTCGeometry = struct RTCGeometryTy*;

constexpr unsigned RTC_INVALID_GEOMETRY_ID = ~0u;

enum RTCDeviceProperty {
    RTC_DEVICE_PROPERTY_VERSION_MAJOR = 1,
    RTC_DEVICE_PROPERTY_VERSION_MINOR = 2,
    RTC_DEVICE_PROPERTY_VERSION_PATCH = 3,
    RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED = 33,
    RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED = 34
};
enum RTCError { RTC_ERROR_NONE = 0 };
enum RTCGeometryType { RTC_GEOMETRY_TYPE_TRIANGLE = 0 };
enum RTCBufferType { RTC_BUFFER_TYPE_INDEX = 0, RTC_BUFFER_TYPE_VERTEX = 1 };
enum RTCFormat { RTC_FORMAT_UINT3 = 0x5003, RTC_FORMAT_FLOAT3 = 0x9003 };
enum RTCBuildQuality { RTC_BUILD_QUALITY_LOW = 0, RTC_BUILD_QUALITY_MEDIUM = 1, RTC_BUILD_QUALITY_HIGH = 2 };
enum RTCSceneFlags { RTC_SCENE_FLAG_NONE = 0, RTC_SCENE_FLAG_ROBUST = 1 << 2 };
enum RTCRayQueryFlags { RTC_RAY_QUERY_FLAG_INCOHERENT = 0, RTC_RAY_QUERY_FLAG_COHERENT = 1 << 16 };
constexpr unsigned RTC_FEATURE_FLAG_ALL = ~0u;

// The arguments of rtcIntersect* and of rtcOccluded*, which have two names and one layout there. What is null
// is Embree's default.
struct RTCArguments {
    RTCRayQueryFlags flags;
    unsigned feature_mask;
    void *context, *filter, *callback;
};

// One ray or N, aligned as rtcIntersect1/8/16 ask for. Each row holds a number for each lane.
template <unsigned N> struct alignas(N == 1 ? 16 : 4 * N) RTCRayNt {
    float org[3][N], tnear[N], dir[3][N], time[N], tfar[N];
    unsigned mask[N], id[N], flags[N];
};
template <unsigned N> struct alignas(N == 1 ? 16 : 4 * N) RTCHitNt {
    float ng[3][N], u[N], v[N];
    unsigned primID[N], geomID[N], instID[N], instPrimID[N];
};
template <unsigned N> struct RTCRayHitNt {
    RTCRayNt<N> ray;
    RTCHitNt<N> hit;
};
using RTCRay = RTCRayNt<1>;
using RTCRay8 = RTCRayNt<8>;
using RTCRay16 = RTCRayNt<16>;
using RTCRayHit = RTCRayHitNt<1>;
using RTCRayHit8 = RTCRayHitNt<8>;
using RTCRayHit16 = RTCRayHitNt<16>;

// Rows of a ray or hit of n lanes.
struct RTCRayN;
struct RTCHitN;
struct RTCRayHitN;
template <class Number> Number& rtc_row(void* rows, unsigned row, unsigned n, unsigned i) {
    return static_cast<Number*>(rows)[row * n + i];
}
inline float& RTCRayN_org_x(RTCRayN* ray, unsigned n, unsigned i) { return rtc_row<float>(ray, 0, n, i); }
inline float& RTCRayN_org_y(RTCRayN* ray, unsigned n, unsigned i) { return rtc_row<float>(ray, 1, n, i); }
inline float& RTCRayN_org_z(RTCRayN* ray, unsigned n, unsigned i) { return rtc_row<float>(ray, 2, n, i); }
inline float& RTCRayN_tnear(RTCRayN* ray, unsigned n, unsigned i) { return rtc_row<float>(ray, 3, n, i); }
inline float& RTCRayN_dir_x(RTCRayN* ray, unsigned n, unsigned i) { return rtc_row<float>(ray, 4, n, i); }
inline float& RTCRayN_dir_y(RTCRayN* ray, unsigned n, unsigned i) { return rtc_row<float>(ray, 5, n, i); }
inline float& RTCRayN_dir_z(RTCRayN* ray, unsigned n, unsigned i) { return rtc_row<float>(ray, 6, n, i); }
inline float& RTCRayN_time(RTCRayN* ray, unsigned n, unsigned i) { return rtc_row<float>(ray, 7, n, i); }
inline float& RTCRayN_tfar(RTCRayN* ray, unsigned n, unsigned i) { return rtc_row<float>(ray, 8, n, i); }
inline unsigned& RTCRayN_mask(RTCRayN* ray, unsigned n, unsigned i) { return rtc_row<unsigned>(ray, 9, n, i); }
inline unsigned& RTCRayN_id(RTCRayN* ray, unsigned n, unsigned i) { return rtc_row<unsigned>(ray, 10, n, i); }
inline unsigned& RTCRayN_flags(RTCRayN* ray, unsigned n, unsigned i) { return rtc_row<unsigned>(ray, 11, n, i); }
inline unsigned& RTCHitN_primID(RTCHitN* hit, unsigned n, unsigned i) { return rtc_row<unsigned>(hit, 5, n, i); }
inline unsigned& RTCHitN_geomID(RTCHitN* hit, unsigned n, unsigned i) { return rtc_row<unsigned>(hit, 6, n, i); }
inline unsigned& RTCHitN_instID(RTCHitN* hit, unsigned n, unsigned i, unsigned) { return rtc_row<unsigned>(hit, 7, n, i); }
inline unsigned& RTCHitN_instPrimID(RTCHitN* hit, unsigned n, unsigned i, unsigned) { return rtc_row<unsigned>(hit, 8, n, i); }
inline RTCHitN* RTCRayHitN_HitN(RTCRayHitN* both, unsigned n) { return reinterpret_cast<RTCHitN*>(&rtc_row<float>(both, 12, n, 0)); }

extern "C" {
RTCDevice rtcNewDevice(const char* config);
void rtcReleaseDevice(RTCDevice device);
ssize_t rtcGetDeviceProperty(RTCDevice device, RTCDeviceProperty property);
RTCError rtcGetDeviceError(RTCDevice device);

RTCGeometry rtcNewGeometry(RTCDevice device, RTCGeometryType type);
void rtcSetSharedGeometryBuffer(RTCGeometry geometry, RTCBufferType type, unsigned slot, RTCFormat format, const void* data,
                                size_t byte_offset, size_t byte_stride, size_t items);
void rtcCommitGeometry(RTCGeometry geometry);
void rtcReleaseGeometry(RTCGeometry geometry);

RTCScene rtcNewScene(RTCDevice device);
void rtcAttachGeometryByID(RTCScene scene, RTCGeometry geometry, unsigned id);
void rtcSetSceneBuildQuality(RTCScene scene, RTCBuildQuality quality);
void rtcSetSceneFlags(RTCScene scene, RTCSceneFlags flags);
void rtcCommitScene(RTCScene scene);
void rtcReleaseScene(RTCScene scene);

void rtcIntersect1(RTCScene scene, RTCRayHit* ray, RTCArguments* arguments);
void rtcIntersect8(const int* valid, RTCScene scene, RTCRayHit8* rays, RTCArguments* arguments);
void rtcIntersect16(const int* valid, RTCScene scene, RTCRayHit16* rays, RTCArguments* arguments);
void rtcOccluded1(RTCScene scene, RTCRay* ray, RTCArguments* arguments);
void rtcOccluded8(const int* valid, RTCScene scene, RTCRay8* rays, RTCArguments* arguments);
void rtcOccluded16(const int* valid, RTCScene scene, RTCRay16* rays, RTCArguments* arguments);
}
