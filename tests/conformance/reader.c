/* SPDX-License-Identifier: GPL-3.0-or-later
 * A second reader, in C: reads a recording by schemas/recording.md with libhdf5 and libsodium alone, and prints it in
 * the layout of expected.json, without decoded keyframes. For little-endian machines: rows are taken as they are
 * stored.
 *
 * usage: conformance_reader RECORDING
 */
#include <hdf5.h>
#include <inttypes.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { statusBytes = 82, eventBytes = 45, rawSampleBytes = 99, rawCountsBytes = 32 };

static const char* const attributes[] = {
    "format", "format_version", "attempt_uuid", "parent_uuid", "fork_step", "start_utc", "software", "build", "simulation_version",
    "step_result_version", "participant", "operator_kind", "performer_profile", "performer_version", "source_file", "source_sha256", "device",
    "calibration", "station", "mode", "purpose", "handedness", "seed", "tick_seconds", "ticks_per_step", "scene_name", "scene_major", "scene_minor"};

struct Status {
  uint64_t ticks, steps, events, keyframes;
  unsigned completed, outcome;
  unsigned char chain[32];
  hsize_t rows; /* of /status */
};

/* What walking over the data sets needs. */
struct Walk {
  hid_t file;
  const struct Status* status;
  int count;
};

static void fail(const char* what, const char* name) {
  fprintf(stderr, "conformance_reader: %s: %s\n", name, what);
  exit(1);
}

static void* allocate(size_t bytes) {
  void* p = calloc(bytes + 1, 1);
  if (p == NULL) fail("not enough memory", "");
  return p;
}

static void printText(const char* text) {
  putchar('"');
  for (; *text != '\0'; ++text) {
    const unsigned char c = (unsigned char)*text;
    if (c == '"' || c == '\\')
      printf("\\%c", c);
    else if (c < 0x20)
      printf("\\u%04x", c);
    else
      putchar(c);
  }
  putchar('"');
}

static void printHex(const unsigned char* bytes, size_t count) {
  putchar('"');
  for (size_t i = 0; i < count; ++i) printf("%02x", bytes[i]);
  putchar('"');
}

static void printSha(const void* bytes, size_t count) {
  unsigned char digest[crypto_hash_sha256_BYTES];
  crypto_hash_sha256(digest, bytes, count);
  printHex(digest, sizeof digest);
}

static void printNumber(const unsigned char* at, H5T_class_t class, size_t size, H5T_sign_t sign) {
  if (class == H5T_FLOAT && size == 8) {
    double v;
    memcpy(&v, at, 8);
    printf("%.17g", v);
  } else if (class == H5T_FLOAT) {
    float v;
    memcpy(&v, at, 4);
    printf("%.17g", (double)v);
  } else {
    uint64_t bits = 0;
    memcpy(&bits, at, size);
    if (sign == H5T_SGN_2)
      printf("%" PRId64, (int64_t)bits); /* all signed ones have eight bytes */
    else
      printf("%" PRIu64, bits);
  }
}

/* Rows [first, first + count) of a data set, in its own type. */
static unsigned char* readRows(hid_t file, const char* path, hsize_t first, hsize_t count, size_t* bytes) {
  const hid_t data = H5Dopen2(file, path, H5P_DEFAULT);
  if (data < 0) fail("is missing", path);
  const hid_t type = H5Dget_type(data), space = H5Dget_space(data);
  hsize_t shape[2] = {0, 1};
  const int dimensions = H5Sget_simple_extent_dims(space, shape, NULL);
  if (dimensions < 1 || dimensions > 2 || shape[0] < first + count) fail("has fewer rows than /status says", path);
  const hsize_t start[2] = {first, 0}, extent[2] = {count, shape[1]};
  H5Sselect_hyperslab(space, H5S_SELECT_SET, start, NULL, extent, NULL);
  const hid_t memory = H5Screate_simple(dimensions, extent, NULL);
  *bytes = (size_t)(count * (dimensions == 2 ? shape[1] : 1)) * H5Tget_size(type);
  unsigned char* rows = allocate(*bytes);
  if (count > 0 && H5Dread(data, type, memory, space, H5P_DEFAULT, rows) < 0) fail("cannot be read", path);
  H5Sclose(memory);
  H5Sclose(space);
  H5Tclose(type);
  H5Dclose(data);
  return rows;
}

static hsize_t rowsOf(hid_t file, const char* path) {
  const hid_t data = H5Dopen2(file, path, H5P_DEFAULT);
  if (data < 0) fail("is missing", path);
  const hid_t space = H5Dget_space(data);
  hsize_t shape[2] = {0, 0};
  H5Sget_simple_extent_dims(space, shape, NULL);
  H5Sclose(space);
  H5Dclose(data);
  return shape[0];
}

static void printAttributes(hid_t file) {
  printf("{\"attributes\":{");
  for (size_t i = 0; i < sizeof attributes / sizeof *attributes; ++i) {
    const hid_t attribute = H5Aopen(file, attributes[i], H5P_DEFAULT);
    if (attribute < 0) fail("is missing", attributes[i]);
    const hid_t type = H5Aget_type(attribute);
    unsigned char* value = allocate(H5Tget_size(type));
    H5Aread(attribute, type, value);
    printf("%s\"%s\":", i > 0 ? "," : "", attributes[i]);
    if (H5Tget_class(type) == H5T_STRING)
      printText((const char*)value);
    else
      printNumber(value, H5Tget_class(type), H5Tget_size(type), H5Tget_class(type) == H5T_INTEGER ? H5Tget_sign(type) : H5T_SGN_NONE);
    free(value);
    H5Tclose(type);
    H5Aclose(attribute);
  }
  printf("},\n");
}

static struct Status readStatus(hid_t file) {
  struct Status s;
  size_t bytes;
  s.rows = rowsOf(file, "/status");
  if (s.rows == 0) fail("has no row", "/status");
  unsigned char* row = readRows(file, "/status", s.rows - 1, 1, &bytes);
  if (bytes != statusBytes) fail("has rows of another size", "/status");
  memcpy(&s.ticks, row, 8);
  memcpy(&s.steps, row + 8, 8);
  memcpy(&s.events, row + 16, 8);
  memcpy(&s.keyframes, row + 24, 8);
  s.completed = row[40];
  s.outcome = row[41];
  memcpy(s.chain, row + 50, 32);
  free(row);
  return s;
}

static void printRow(const unsigned char* row, hsize_t width, int vector, hid_t type) {
  const size_t size = H5Tget_size(type);
  const H5T_class_t class = H5Tget_class(type);
  const H5T_sign_t sign = class == H5T_INTEGER ? H5Tget_sign(type) : H5T_SGN_NONE;
  if (vector) putchar('[');
  for (hsize_t i = 0; i < width; ++i) {
    if (i > 0) putchar(',');
    printNumber(row + i * size, class, size, sign);
  }
  if (vector) putchar(']');
}

static herr_t visit(hid_t root, const char* name, const H5O_info_t* info, void* data) {
  struct Walk* walk = data;
  char path[256];
  (void)root;
  if (info->type != H5O_TYPE_DATASET || snprintf(path, sizeof path, "/%s", name) >= (int)sizeof path) return 0;
  uint64_t rows;
  if (strncmp(path, "/ticks/", 7) == 0 || strncmp(path, "/camera/", 8) == 0)
    rows = walk->status->ticks;
  else if (strncmp(path, "/steps/", 7) == 0 || strncmp(path, "/observables/", 13) == 0)
    rows = walk->status->steps;
  else
    return 0;
  if (strstr(path, "_names") != NULL || strcmp(path, "/steps/field_component") == 0) return 0;
  const hid_t set = H5Dopen2(walk->file, path, H5P_DEFAULT), type = H5Dget_type(set), space = H5Dget_space(set);
  hsize_t shape[2] = {0, 1};
  const int vector = H5Sget_simple_extent_dims(space, shape, NULL) == 2;
  const hsize_t width = vector ? shape[1] : 1;
  size_t bytes;
  unsigned char* values = readRows(walk->file, path, 0, rows, &bytes);
  const char kind = H5Tget_class(type) == H5T_FLOAT ? 'f' : H5Tget_sign(type) == H5T_SGN_2 ? 'i' : 'u';
  printf("%s\"%s\":{\"type\":\"%c%zu\",\"shape\":[%" PRIu64, walk->count++ > 0 ? ",\n" : "", path, kind, H5Tget_size(type), rows);
  if (vector) printf(",%" PRIu64, (uint64_t)width);
  printf("],\"sha256\":");
  printSha(values, bytes);
  if (rows > 0) {
    printf(",\"first\":");
    printRow(values, width, vector, type);
    printf(",\"last\":");
    printRow(values + bytes / rows * (rows - 1), width, vector, type);
  }
  putchar('}');
  free(values);
  H5Sclose(space);
  H5Tclose(type);
  H5Dclose(set);
  return 0;
}

static void printEvents(hid_t file, uint64_t count) {
  size_t bytes;
  unsigned char* rows = readRows(file, "/events", 0, count, &bytes);
  if (bytes != count * eventBytes) fail("has rows of another size", "/events");
  printf("\"events\":[");
  for (uint64_t i = 0; i < count; ++i) {
    const unsigned char* row = rows + i * eventBytes;
    printf("%s{\"step\":", i > 0 ? "," : "");
    printNumber(row, H5T_INTEGER, 8, H5T_SGN_NONE);
    printf(",\"kind\":");
    printNumber(row + 8, H5T_INTEGER, 2, H5T_SGN_NONE);
    printf(",\"hand\":%u,\"subject\":", row[10]);
    printNumber(row + 11, H5T_INTEGER, 2, H5T_SGN_NONE);
    printf(",\"position\":[");
    for (size_t axis = 0; axis < 3; ++axis) {
      if (axis > 0) putchar(',');
      printNumber(row + 13 + 8 * axis, H5T_FLOAT, 8, H5T_SGN_NONE);
    }
    printf("],\"value\":");
    printNumber(row + 37, H5T_FLOAT, 8, H5T_SGN_NONE);
    putchar('}');
  }
  printf("]");
  free(rows);
}

static void printDevice(hid_t file, const struct Status* status) {
  static const char* const samples[] = {"/device/left/samples", "/device/right/samples"};
  size_t bytes;
  unsigned char* counts = readRows(file, "/device/counts", status->rows - 1, 1, &bytes);
  if (bytes != rawCountsBytes) fail("has rows of another size", "/device/counts");
  printf(",\n\"device\":{");
  for (int hand = 0; hand < 2; ++hand) {
    uint64_t rows;
    memcpy(&rows, counts + 8 * hand, 8);
    unsigned char* values = readRows(file, samples[hand], 0, rows, &bytes);
    if (bytes != rows * rawSampleBytes) fail("has rows of another size", samples[hand]);
    printf("%s:{\"rows\":%" PRIu64 ",\"sha256\":", hand == 0 ? "\"left\"" : ",\"right\"", rows);
    printSha(values, bytes);
    putchar('}');
    free(values);
  }
  putchar('}');
  free(counts);
}

static void printSignature(hid_t file, const struct Status* status) {
  size_t keyBytes, bytes;
  unsigned char* key = readRows(file, "/signature/public_key", 0, crypto_sign_PUBLICKEYBYTES, &keyBytes);
  unsigned char* value = readRows(file, "/signature/value", 0, rowsOf(file, "/signature/value"), &bytes);
  const int valid = bytes == crypto_sign_BYTES && crypto_sign_verify_detached(value, status->chain, 32, key) == 0;
  printf(",\n\"signature\":{\"public_key\":");
  printHex(key, keyBytes);
  printf(",\"value\":");
  printHex(value, bytes);
  printf(",\"valid\":%s}", valid ? "true" : "false");
  free(key);
  free(value);
}

/* A file whose writer was killed is open for SWMR reading alone: byte 11 of the superblock. */
static unsigned accessOf(const char* path) {
  unsigned char head[12] = {0};
  FILE* raw = fopen(path, "rb");
  if (raw == NULL || fread(head, 1, sizeof head, raw) != sizeof head) fail("cannot be read", path);
  fclose(raw);
  return H5F_ACC_RDONLY | ((head[11] & 5) != 0 ? H5F_ACC_SWMR_READ : 0);
}

int main(int argc, char** argv) {
  if (argc != 2 || sodium_init() < 0) fail("a recording is wanted", "usage");
  H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
  const hid_t how = H5Pcreate(H5P_FILE_ACCESS);
  H5Pset_libver_bounds(how, H5F_LIBVER_V110, H5F_LIBVER_V110);
  const hid_t file = H5Fopen(argv[1], accessOf(argv[1]), how);
  if (file < 0) fail("is no HDF5 file that can be opened", argv[1]);
  printAttributes(file);
  const struct Status status = readStatus(file);
  printf("\"complete\":%s,\"outcome\":%u,\"counts\":{\"ticks\":%" PRIu64 ",\"steps\":%" PRIu64 ",\"events\":%" PRIu64 ",\"keyframes\":%" PRIu64
         "},\"chain\":",
         status.completed ? "true" : "false", status.outcome, status.ticks, status.steps, status.events, status.keyframes);
  printHex(status.chain, sizeof status.chain);
  printf(",\n\"datasets\":{");
  struct Walk walk = {file, &status, 0};
  if (H5Ovisit2(file, H5_INDEX_NAME, H5_ITER_INC, visit, &walk, H5O_INFO_BASIC) < 0) fail("cannot be walked through", argv[1]);
  printf("},\n");
  printEvents(file, status.events);
  if (H5Lexists(file, "/device", H5P_DEFAULT) > 0) printDevice(file, &status);
  if (H5Lexists(file, "/signature", H5P_DEFAULT) > 0) printSignature(file, &status);
  printf("}\n");
  H5Fclose(file);
  H5Pclose(how);
  return 0;
}
