#include "beam/response.h"

namespace mane::beam {

std::vector<double> HoldOf(double rigidity, double line_density, double length, int segments) {
  std::vector<double> hold;
  for (int i = 1; i <= segments; ++i) {
    const double left = length * (1 - (i - 0.5) / segments);
    hold.push_back(6 * rigidity / (line_density * (length * length * length - left * left * left)));
  }
  return hold;
}

std::vector<double> ResponseOf(double length, int segments) {
  std::vector<double> response;
  for (int i = 1; i <= segments; ++i) response.push_back(2.1 / length * i / segments);
  return response;
}

std::vector<double> PublishedResponse(double segment_length, double unit, int segments) {
  const double k = segments;
  std::vector<double> response;
  for (int i = 1; i <= segments; ++i) {
    response.push_back(3 * i / (2 * k * k * k * unit * segment_length));
  }
  return response;
}

}  // namespace mane::beam
