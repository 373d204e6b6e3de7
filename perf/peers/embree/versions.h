// Embree 3 and 4 under the same names: what differs between them, besides the streams that only Embree 3 has,
// is here. The compiler's -DEMBREE=3 or -DEMBREE=4 chooses.
#pragma once

#if EMBREE == 3
#include <embree3/rtcore.h>

struct Query {
    RTCIntersectContext context;

    explicit Query(bool coherent) {
        rtcInitIntersectContext(&context);
        context.flags = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    }
};

inline void set_no_instance(RTCHitN* hit, unsigned n, unsigned lane) { RTCHitN_instID(hit, n, lane, 0) = RTC_INVALID_GEOMETRY_ID; }

inline void call(const int*, RTCScene scene, Query& query, RTCRayHit& ray) {
    rtcIntersect1(scene, &query.context, &ray);
}
inline void call(const int* valid, RTCScene scene, Query& query, RTCRayHit8& rays) {
    rtcIntersect8(valid, scene, &query.context, &rays);
}
inline void call(const int* valid, RTCScene scene, Query& query, RTCRayHit16& rays) {
    rtcIntersect16(valid, scene, &query.context, &rays);
}
inline void call(const int*, RTCScene scene, Query& query, RTCRay& ray) {
    rtcOccluded1(scene, &query.context, &ray);
}
inline void call(const int* valid, RTCScene scene, Query& query, RTCRay8& rays) {
    rtcOccluded8(valid, scene, &query.context, &rays);
}
inline void call(const int* valid, RTCScene scene, Query& query, RTCRay16& rays) {
    rtcOccluded16(valid, scene, &query.context, &rays);
}

#elif EMBREE == 4
#include "embree4.h"

struct Query {
    RTCArguments arguments;

    explicit Query(bool coherent)
        : arguments{coherent ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT, RTC_FEATURE_FLAG_ALL, nullptr, nullptr,
                    nullptr} {}
};

inline void set_no_instance(RTCHitN* hit, unsigned n, unsigned lane) {
    RTCHitN_instID(hit, n, lane, 0) = RTC_INVALID_GEOMETRY_ID;
    RTCHitN_instPrimID(hit, n, lane, 0) = RTC_INVALID_GEOMETRY_ID;
}

inline void call(const int*, RTCScene scene, Query& query, RTCRayHit& ray) {
    rtcIntersect1(scene, &ray, &query.arguments);
}
inline void call(const int* valid, RTCScene scene, Query& query, RTCRayHit8& rays) {
    rtcIntersect8(valid, scene, &rays, &query.arguments);
}
inline void call(const int* valid, RTCScene scene, Query& query, RTCRayHit16& rays) {
    rtcIntersect16(valid, scene, &rays, &query.arguments);
}
inline void call(const int*, RTCScene scene, Query& query, RTCRay& ray) {
    rtcOccluded1(scene, &ray, &query.arguments);
}
inline void call(const int* valid, RTCScene scene, Query& query, RTCRay8& rays) {
    rtcOccluded8(valid, scene, &rays, &query.arguments);
}
inline void call(const int* valid, RTCScene scene, Query& query, RTCRay16& rays) {
    rtcOccluded16(valid, scene, &rays, &query.arguments);
}

#else
#error "compile with -DEMBREE=3 or -DEMBREE=4"
#endif
