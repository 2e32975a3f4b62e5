#pragma once

#include <string>

#include "base/result.h"
#include "groom/assemble.h"
#include "groom/body.h"
#include "groom/groom.h"
#include "head/bodies.h"
#include "mane/v1/groom.pb.h"
#include "stored.pb.h"

namespace mane::rpc {

/// Bodies of groom.proto to the domain and back.

/// A body without its mesh's lists, in their stead an empty mesh; checked by groom::MakeBody.
///
/// @param index  of the body in its groom. @return kInvalidArgument naming `bodies[<index>].shape`
///   where it has none, or the first field out of its range.
[[nodiscard]] Result<groom::Body> ToBody(const v1::Body& message, int index);

/// Appends the lists of a piece to `mesh`. kInvalidArgument naming `bodies[<index>].mesh.` and the
/// field for bytes that are no whole number of entries, and for hair triangles.
[[nodiscard]] Result<void> AppendBodyMesh(const v1::TriangleMesh& piece, int index,
                                          groom::Body::Mesh* mesh);

/// A whole body: ToBody and AppendBodyMesh.
[[nodiscard]] Result<groom::Body> ToWholeBody(const v1::Body& message, int index);

/// All but the lists of a mesh. Friction in numbers.
void FromBody(const groom::Body& body, v1::Body* message);

/// The mesh of a body; null for other shapes.
[[nodiscard]] const groom::Body::Mesh* MeshOf(const groom::Body& body);
/// Of both lists of a mesh the entries from `begin` on, `count` of them at most.
void FromBodyMesh(const groom::Body::Mesh& mesh, size_t begin, size_t count,
                  v1::TriangleMesh* message);

/// The inverse of ToWholeBody.
void FromWholeBody(const groom::Body& body, v1::Body* message);

/// Friction of the scalp; kInvalidArgument names a field of `header.scalp_contact`.
[[nodiscard]] Result<groom::Friction> ToScalpFriction(const v1::ScalpContact& message);
void FromScalpFriction(const groom::Friction& friction, v1::ScalpContact* message);

/// What the description of a groom of `parts` tells of its bodies.
///
/// @param bodies  those of `parts`; null for none.
[[nodiscard]] StoredContact DescribeContact(const groom::Parts& parts, const head::Bodies* bodies);

}  // namespace mane::rpc
