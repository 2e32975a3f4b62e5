#include "groom_upload.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <variant>
#include <vector>

#include "convert.h"

namespace mane::inline client {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are copied as they are");

// A batch is sent once it exceeds this; one guide adds at most 9 KiB, one strand 13.
constexpr size_t kBatchBytes = 256 << 10;

using Write = std::function<bool(const v1::CreateGroomRequest&)>;

v1::CreateGroomRequest Header(const GroomUpload& upload) {
  v1::CreateGroomRequest request;
  v1::CreateGroomHeader& header = *request.mutable_header();
  header.set_groom_id(upload.groom_id);
  header.set_display_name(upload.display_name);
  header.set_request_id(upload.request_id);
  if (const auto* ellipsoid = std::get_if<EllipsoidScalp>(&upload.scalp)) {
    *header.mutable_ellipsoid() = ToProto(*ellipsoid);
  }
  if (const auto* generation = std::get_if<GuideGeneration>(&upload.guides)) {
    *header.mutable_generate() = ToProto(*generation);
  }
  if (const auto* import = std::get_if<StrandImport>(&upload.guides)) {
    *header.mutable_import_options() = ToProto(import->options);
  }
  header.set_hair_offset_unit_m(upload.hairs.offset_unit_m);
  if (upload.scalp_contact) *header.mutable_scalp_contact() = ToProto(*upload.scalp_contact);
  return request;
}

// Sends entries in batches; `add` puts one into a request and tells its bytes.
template <typename Entry, typename Add>
bool WriteBatches(const std::vector<Entry>& entries, const Add& add, const Write& write) {
  v1::CreateGroomRequest request;
  size_t bytes = 0;
  for (size_t i = 0; i < entries.size(); ++i) {
    bytes += add(entries[i], &request);
    if (bytes < kBatchBytes && i + 1 < entries.size()) continue;
    if (!write(request)) return false;
    request.Clear();
    bytes = 0;
  }
  return true;
}

size_t AddGuide(const Guide& guide, v1::CreateGroomRequest* request) {
  v1::Guide* message = request->mutable_guides()->add_guides();
  *message = ToProto(guide);
  return message->ByteSizeLong();
}

size_t AddStrand(const ImportedStrand& strand, v1::CreateGroomRequest* request) {
  v1::ImportedStrand* message = request->mutable_strands()->add_strands();
  *message = ToProto(strand);
  return message->ByteSizeLong();
}

// Sends one list of a mesh in pieces; `place` makes the request of a piece and tells where its
// bytes go.
template <typename Number, typename Place>
bool WriteList(const std::vector<Number>& numbers, const Place& place, const Write& write) {
  const size_t step = kBatchBytes / (3 * sizeof(Number)) * 3;  // Whole vertices and triangles.
  for (size_t first = 0; first < numbers.size(); first += step) {
    const size_t count = std::min(step, numbers.size() - first);
    v1::CreateGroomRequest request;
    place(&request)->assign(reinterpret_cast<const char*>(numbers.data() + first),
                            count * sizeof(Number));
    if (!write(request)) return false;
  }
  return true;
}

bool WriteScalp(const TriangleMesh& mesh, const Write& write) {
  using Request = v1::CreateGroomRequest*;
  return WriteList(
             mesh.vertices, [](Request r) { return r->mutable_scalp_mesh()->mutable_vertices(); },
             write) &&
         WriteList(
             mesh.triangles, [](Request r) { return r->mutable_scalp_mesh()->mutable_triangles(); },
             write) &&
         WriteList(
             mesh.hair_triangles,
             [](Request r) { return r->mutable_scalp_mesh()->mutable_hair_triangles(); }, write);
}

// A body, then pieces of its mesh under its name.
bool WriteBody(const Body& body, const Write& write) {
  v1::CreateGroomRequest request;
  *request.mutable_body() = ToProto(body);
  if (!write(request)) return false;
  const auto* mesh = std::get_if<TriangleMesh>(&body.shape);
  if (mesh == nullptr) return true;
  const auto piece = [&body](v1::CreateGroomRequest* r) {
    r->mutable_body()->set_name(body.name);
    return r->mutable_body()->mutable_mesh();
  };
  return WriteList(
             mesh->vertices, [&](auto* r) { return piece(r)->mutable_vertices(); }, write) &&
         WriteList(
             mesh->triangles, [&](auto* r) { return piece(r)->mutable_triangles(); }, write) &&
         WriteList(
             mesh->hair_triangles, [&](auto* r) { return piece(r)->mutable_hair_triangles(); },
             write);
}

// Entries from `first` on, `count` of them or as many as there are, as bytes.
template <typename Entry>
std::string Piece(const std::vector<Entry>& entries, size_t first, size_t count) {
  first = std::min(first, entries.size());
  count = std::min(count, entries.size() - first);
  return {reinterpret_cast<const char*>(entries.data() + first), count * sizeof(Entry)};
}

// Batches of whole hairs. The last one has the rest of every list, so that lists that do not fit
// each other arrive as such, and are refused by name.
bool WriteHairs(const Hairs& hairs, const Write& write) {
  const std::vector<std::uint16_t>& counts = hairs.point_counts;
  size_t place = 0;
  for (size_t hair = 0; hair < hairs.guides.size();) {
    size_t end = hair, points = 0;
    while (end < hairs.guides.size() &&
           points * sizeof(HairPlace) + 9 * (end - hair) < kBatchBytes) {
      points += end < counts.size() ? counts[end] : 0;
      ++end;
    }
    const auto whole = [last = end == hairs.guides.size()](size_t count) {
      return last ? std::numeric_limits<size_t>::max() : count;
    };
    v1::CreateGroomRequest request;
    v1::HairBatch& batch = *request.mutable_hairs();
    batch.set_guides(Piece(hairs.guides, hair, end - hair));
    batch.set_point_counts(Piece(counts, hair, whole(end - hair)));
    batch.set_places(Piece(hairs.places, place, whole(points)));
    batch.set_colours(Piece(hairs.colours, 3 * hair, whole(3 * (end - hair))));
    if (!write(request)) return false;
    hair = end;
    place += points;
  }
  return true;
}

}  // namespace

void ForEachPart(const GroomUpload& upload, const Write& write) {
  if (!write(Header(upload))) return;
  if (const auto* mesh = std::get_if<TriangleMesh>(&upload.scalp)) {
    if (!WriteScalp(*mesh, write)) return;
  }
  for (const Body& body : upload.bodies) {
    if (!WriteBody(body, write)) return;
  }
  if (const auto* guides = std::get_if<std::vector<Guide>>(&upload.guides)) {
    if (!WriteBatches(*guides, AddGuide, write)) return;
  } else if (const auto* import = std::get_if<StrandImport>(&upload.guides)) {
    if (!WriteBatches(import->strands, AddStrand, write)) return;
  }
  if (!WriteHairs(upload.hairs, write)) return;
  v1::CreateGroomRequest commit;
  commit.mutable_commit();
  write(commit);
}

}  // namespace mane::inline client
