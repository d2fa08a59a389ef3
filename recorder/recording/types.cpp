// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/recording/types.h"

#include <algorithm>

namespace calot::recorder::hdf5 {

namespace {

Id eventType() {
  Id t = type(H5Tcreate(H5T_COMPOUND, eventBytes));
  const hsize_t three = 3;
  const Id vector = type(H5Tarray_create2(H5T_IEEE_F64LE, 1, &three));
  H5Tinsert(t.get(), "step", 0, H5T_STD_U64LE);
  H5Tinsert(t.get(), "kind", 8, H5T_STD_U16LE);
  H5Tinsert(t.get(), "hand", 10, H5T_STD_U8LE);
  H5Tinsert(t.get(), "subject", 11, H5T_STD_U16LE);
  H5Tinsert(t.get(), "position", 13, vector.get());
  H5Tinsert(t.get(), "value", 37, H5T_IEEE_F64LE);
  return t;
}

Id keyframeType() {
  Id t = type(H5Tcreate(H5T_COMPOUND, keyframeBytes));
  H5Tinsert(t.get(), "step", 0, H5T_STD_U64LE);
  H5Tinsert(t.get(), "offset", 8, H5T_STD_U64LE);
  H5Tinsert(t.get(), "state_bytes", 16, H5T_STD_U64LE);
  H5Tinsert(t.get(), "haptics_bytes", 24, H5T_STD_U64LE);
  return t;
}

Id statusType() {
  Id t = type(H5Tcreate(H5T_COMPOUND, statusBytes));
  const hsize_t head = 32;
  const Id chain = type(H5Tarray_create2(H5T_STD_U8LE, 1, &head));
  H5Tinsert(t.get(), "ticks", 0, H5T_STD_U64LE);
  H5Tinsert(t.get(), "steps", 8, H5T_STD_U64LE);
  H5Tinsert(t.get(), "events", 16, H5T_STD_U64LE);
  H5Tinsert(t.get(), "keyframes", 24, H5T_STD_U64LE);
  H5Tinsert(t.get(), "keyframe_words", 32, H5T_STD_U64LE);
  H5Tinsert(t.get(), "completed", 40, H5T_STD_U8LE);
  H5Tinsert(t.get(), "outcome", 41, H5T_STD_U8LE);
  H5Tinsert(t.get(), "wall_nanoseconds", 42, H5T_STD_I64LE);
  H5Tinsert(t.get(), "chain", 50, chain.get());
  return t;
}

Id rawSampleType() {
  Id t = type(H5Tcreate(H5T_COMPOUND, rawSampleBytes));
  const hsize_t three = 3, four = 4;
  const Id vector = type(H5Tarray_create2(H5T_IEEE_F64LE, 1, &three));
  const Id quaternion = type(H5Tarray_create2(H5T_IEEE_F64LE, 1, &four));
  H5Tinsert(t.get(), "device_time", 0, H5T_STD_I64LE);
  H5Tinsert(t.get(), "host_time", 8, H5T_STD_I64LE);
  H5Tinsert(t.get(), "sequence", 16, H5T_STD_U64LE);
  H5Tinsert(t.get(), "tick", 24, H5T_STD_U64LE);
  H5Tinsert(t.get(), "position", 32, vector.get());
  H5Tinsert(t.get(), "orientation", 56, quaternion.get());
  H5Tinsert(t.get(), "gripper", 88, H5T_IEEE_F64LE);
  H5Tinsert(t.get(), "buttons", 96, H5T_STD_U8LE);
  H5Tinsert(t.get(), "valid", 97, H5T_STD_U8LE);
  H5Tinsert(t.get(), "used", 98, H5T_STD_U8LE);
  return t;
}

Id rawCountsType() {
  Id t = type(H5Tcreate(H5T_COMPOUND, rawCountsBytes));
  H5Tinsert(t.get(), "left", 0, H5T_STD_U64LE);
  H5Tinsert(t.get(), "right", 8, H5T_STD_U64LE);
  H5Tinsert(t.get(), "left_dropped", 16, H5T_STD_U64LE);
  H5Tinsert(t.get(), "right_dropped", 24, H5T_STD_U64LE);
  return t;
}

}  // namespace

Id elementType(Element element) {
  switch (element) {
    case Element::u1:
      return type(H5Tcopy(H5T_STD_U8LE));
    case Element::u2:
      return type(H5Tcopy(H5T_STD_U16LE));
    case Element::u4:
      return type(H5Tcopy(H5T_STD_U32LE));
    case Element::u8:
      return type(H5Tcopy(H5T_STD_U64LE));
    case Element::i8:
      return type(H5Tcopy(H5T_STD_I64LE));
    case Element::f4:
      return type(H5Tcopy(H5T_IEEE_F32LE));
    case Element::f8:
      return type(H5Tcopy(H5T_IEEE_F64LE));
    case Element::event:
      return eventType();
    case Element::keyframe:
      return keyframeType();
    case Element::status:
      return statusType();
    case Element::rawSample:
      return rawSampleType();
    case Element::rawCounts:
      return rawCountsType();
  }
  return {};
}

Id stringType(std::size_t bytes) {
  Id t = type(H5Tcopy(H5T_C_S1));
  H5Tset_size(t.get(), std::max<std::size_t>(1, bytes));
  H5Tset_strpad(t.get(), H5T_STR_NULLPAD);
  H5Tset_cset(t.get(), H5T_CSET_UTF8);
  return t;
}

Id fileAccess(unsigned metadataAttempts) {
  Id p = properties(H5Pcreate(H5P_FILE_ACCESS));
  H5Pset_libver_bounds(p.get(), H5F_LIBVER_V110, H5F_LIBVER_V110);
  H5Pset_fclose_degree(p.get(), H5F_CLOSE_STRONG);
  if (metadataAttempts > 0) H5Pset_metadata_read_attempts(p.get(), metadataAttempts);
  return p;
}

Id datasetAccess(std::size_t chunkBytes) {
  Id p = properties(H5Pcreate(H5P_DATASET_ACCESS));
  H5Pset_chunk_cache(p.get(), 3, 2 * chunkBytes, 1.0);
  return p;
}

}  // namespace calot::recorder::hdf5
