#pragma once

#include <grpcpp/grpcpp.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "frame_decoder.h"
#include "mane/v1/groom.grpc.pb.h"
#include "transport.h"

namespace mane::inline client {

/// Fetches the geometry of a groom's guides without blocking.
///
/// Lifetime: created by Start(), owned by gRPC until OnDone, which hands it to `done`; Cancel() may
/// come at any time before that.
class ExportCall final : public grpc::ClientReadReactor<v1::ExportGroomResponse> {
 public:
  /// Called once from gRPC's threads. The receiver drops `call`.
  using Done = std::function<void(std::unique_ptr<ExportCall> call, const grpc::Status& status)>;

  static ExportCall* Start(const Transport& transport, const std::string& groom, Done done);

  void Cancel() { context_.TryCancel(); }
  /// What was read; whole when the status is OK.
  std::vector<GuideGeometry> TakeGuides() { return std::move(guides_); }

  void OnReadDone(bool ok) override;
  void OnDone(const grpc::Status& status) override;

 private:
  explicit ExportCall(Done done) : done_(std::move(done)) {}

  Done done_;
  grpc::ClientContext context_;
  v1::ExportGroomRequest request_;
  v1::ExportGroomResponse response_;
  std::vector<GuideGeometry> guides_;
};

}  // namespace mane::inline client
