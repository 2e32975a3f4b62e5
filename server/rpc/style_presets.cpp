#include "rpc/style_presets.h"

#include <google/protobuf/util/json_util.h>

#include "base/check.h"

namespace mane::rpc {
namespace {

struct Preset {
  const char* name;
  const char* description;
  const char* style;  // JSON.
};

// Places are those of a head of human size: crown at y = 0.14 m, forehead at z = 0.11 m, nape at
// y = -0.03 m, z = -0.06 m.
constexpr Preset kPresets[] = {
    {"bob", "Straight hair cut level at the chin, with a fringe.",
     R"json(
{"seed": 7,
 "length": {"value": 0.26,
  "by_azimuth": [{"at": -0.7, "value": 1}, {"at": -0.5, "value": 0.38}, {"at": 0.5, "value": 0.38},
   {"at": 0.7, "value": 1}]},
 "protrusion": {"value": 0.35},
 "member_length": {"normal": {"mean": 0.98, "deviation": 0.02, "low": 0.9, "high": 1}},
 "radii_m": [0.008, 0.012, 0.008],
 "fuzziness": 0.06,
 "bending_stiffness": 0.5,
 "density_threshold": 0.8,
 "colour": {"hue": {"normal": {"mean": 0.06, "deviation": 0.02, "low": 0, "high": 0.2}},
  "saturation": {"normal": {"mean": 0.35, "deviation": 0.06, "low": 0.1, "high": 0.6}},
  "value": {"normal": {"mean": 0.13, "deviation": 0.03, "low": 0.05, "high": 0.25}},
  "wisp_share": 0.4},
 "operations": [{"cut": {"plane": {"normal": {"x": 0, "y": 1, "z": 0}, "offset_m": -0.085}}}]}
)json"},
    {"ponytail", "Long hair tied high at the back of the head.",
     R"json(
{"seed": 7,
 "length": {"value": 0.42},
 "protrusion": {"value": 0.2},
 "member_length": {"normal": {"mean": 0.95, "deviation": 0.05, "low": 0.7, "high": 1}},
 "radii_m": [0.006, 0.008, 0.012, 0.004],
 "fuzziness": 0.08,
 "synthesis": {"prototype": {"kind": "STRAND_KIND_WAVY", "amplitude_m": 0.004, "period_m": 0.09},
  "temperature": 0.05},
 "bending_stiffness": 0.4,
 "colour": {"hue": {"normal": {"mean": 0.11, "deviation": 0.008, "low": 0.05, "high": 0.2}},
  "saturation": {"normal": {"mean": 0.45, "deviation": 0.06, "low": 0.2, "high": 0.7}},
  "value": {"normal": {"mean": 0.7, "deviation": 0.07, "low": 0.45, "high": 0.95}},
  "wisp_share": 0.6},
 "operations": [{"tie": {"point": {"x": 0, "y": 0.075, "z": -0.115}, "radius_m": 0.016}}]}
)json"},
    {"updo", "Long hair gathered at the back of the head and wound into a bun.",
     R"json(
{"seed": 7,
 "length": {"value": 0.5},
 "protrusion": {"value": 0.15},
 "member_length": {"normal": {"mean": 0.95, "deviation": 0.05, "low": 0.7, "high": 1}},
 "radii_m": [0.006, 0.006, 0.006, 0.003],
 "fuzziness": 0.05,
 "bending_stiffness": 0.3,
 "colour": {"hue": {"normal": {"mean": 0.07, "deviation": 0.01, "low": 0, "high": 0.2}},
  "saturation": {"normal": {"mean": 0.55, "deviation": 0.06, "low": 0.3, "high": 0.8}},
  "value": {"normal": {"mean": 0.3, "deviation": 0.05, "low": 0.12, "high": 0.5}},
  "wisp_share": 0.5},
 "queues": [{"name": "bun",
   "constraints": [{"kind": "KIND_POINT", "path": [{"x": 0.0, "y": 0.123, "z": -0.095}], "radius_m": 0.014},
    {"kind": "KIND_TRAJECTORY",
     "path": [{"x": 0.0, "y": 0.123, "z": -0.095}, {"x": 0.0106, "y": 0.1205, "z": -0.0958},
      {"x": 0.0193, "y": 0.1143, "z": -0.0966}, {"x": 0.0249, "y": 0.1053, "z": -0.0974},
      {"x": 0.0265, "y": 0.095, "z": -0.0981}, {"x": 0.0242, "y": 0.085, "z": -0.0989},
      {"x": 0.0182, "y": 0.0768, "z": -0.0997}, {"x": 0.0097, "y": 0.0715, "z": -0.1005},
      {"x": 0.0, "y": 0.0699, "z": -0.1013}, {"x": -0.0095, "y": 0.0722, "z": -0.1021},
      {"x": -0.0172, "y": 0.0778, "z": -0.1029}, {"x": -0.0221, "y": 0.0858, "z": -0.1036},
      {"x": -0.0236, "y": 0.095, "z": -0.1044}, {"x": -0.0215, "y": 0.1039, "z": -0.1052},
      {"x": -0.0162, "y": 0.1112, "z": -0.106}, {"x": -0.0086, "y": 0.1158, "z": -0.1068},
      {"x": -0.0, "y": 0.1171, "z": -0.1076}, {"x": 0.0083, "y": 0.1151, "z": -0.1084},
      {"x": 0.0151, "y": 0.1101, "z": -0.1091}, {"x": 0.0194, "y": 0.1031, "z": -0.1099},
      {"x": 0.0207, "y": 0.095, "z": -0.1107}, {"x": 0.0188, "y": 0.0872, "z": -0.1115},
      {"x": 0.0141, "y": 0.0809, "z": -0.1123}, {"x": 0.0075, "y": 0.0769, "z": -0.1131},
      {"x": 0.0, "y": 0.0758, "z": -0.1138}, {"x": -0.0072, "y": 0.0776, "z": -0.1146},
      {"x": -0.0131, "y": 0.0819, "z": -0.1154}, {"x": -0.0167, "y": 0.0881, "z": -0.1162},
      {"x": -0.0177, "y": 0.095, "z": -0.117}, {"x": -0.016, "y": 0.1016, "z": -0.1178},
      {"x": -0.012, "y": 0.107, "z": -0.1186}, {"x": -0.0064, "y": 0.1104, "z": -0.1193},
      {"x": -0.0, "y": 0.1113, "z": -0.1201}, {"x": 0.0061, "y": 0.1097, "z": -0.1209},
      {"x": 0.011, "y": 0.106, "z": -0.1217}, {"x": 0.014, "y": 0.1008, "z": -0.1225},
      {"x": 0.0148, "y": 0.095, "z": -0.1233}, {"x": 0.0133, "y": 0.0895, "z": -0.1241},
      {"x": 0.01, "y": 0.085, "z": -0.1248}, {"x": 0.0052, "y": 0.0823, "z": -0.1256},
      {"x": 0.0, "y": 0.0817, "z": -0.1264}],
     "radius_m": 0.012}]}]}
)json"},
    {"three_strand_braid", "Long hair gathered at the nape and braided down the back.",
     R"json(
{"seed": 7,
 "length": {"value": 0.6},
 "protrusion": {"value": 0.2},
 "member_length": {"normal": {"mean": 0.97, "deviation": 0.02, "low": 0.9, "high": 1}},
 "radii_m": [0.006, 0.006, 0.007, 0.005],
 "fuzziness": 0.04,
 "bending_stiffness": 0.3,
 "colour": {"hue": {"normal": {"mean": 0.045, "deviation": 0.008, "low": 0, "high": 0.1}},
  "saturation": {"normal": {"mean": 0.7, "deviation": 0.06, "low": 0.4, "high": 0.9}},
  "value": {"normal": {"mean": 0.45, "deviation": 0.06, "low": 0.2, "high": 0.7}},
  "wisp_share": 0.5},
 "segment_length_m": 0.008,
 "operations": [{"braid": {"path": [{"x": 0, "y": 0.0, "z": -0.1}, {"x": 0, "y": -0.1, "z": -0.125},
     {"x": 0, "y": -0.32, "z": -0.14}],
    "strand_count": 3,
    "radius_m": 0.02,
    "period_m": 0.1}}]}
)json"},
    {"afro", "Kinky hair that stands away from the head on all sides.",
     R"json(
{"seed": 7,
 "length": {"value": 0.11},
 "protrusion": {"value": 1},
 "member_length": {"normal": {"mean": 0.9, "deviation": 0.1, "low": 0.5, "high": 1.1}},
 "radii_m": [0.008, 0.012],
 "fuzziness": 0.6,
 "segment_length_m": 0.0015,
 "synthesis": {"prototype": {"kind": "STRAND_KIND_KINKY"}, "temperature": 0.3},
 "field": [{"kind": "KIND_RADIAL", "strength": 1, "center": {"x": 0, "y": 0.055, "z": 0.02}}],
 "bending_stiffness": 3,
 "density_threshold": 0.6,
 "colour": {"hue": {"normal": {"mean": 0.06, "deviation": 0.02, "low": 0, "high": 0.2}},
  "saturation": {"normal": {"mean": 0.35, "deviation": 0.06, "low": 0.1, "high": 0.6}},
  "value": {"normal": {"mean": 0.13, "deviation": 0.03, "low": 0.05, "high": 0.25}},
  "wisp_share": 0.4}}
)json"},
    {"pulled_back", "Hair combed back over the head and down to the neck.",
     R"json(
{"seed": 7,
 "length": {"value": 0.3},
 "protrusion": {"value": 0.25},
 "member_length": {"normal": {"mean": 0.95, "deviation": 0.05, "low": 0.7, "high": 1}},
 "radii_m": [0.006, 0.009, 0.006],
 "fuzziness": 0.05,
 "field": [{"kind": "KIND_UNIFORM", "strength": 0.6, "direction": {"x": 0, "y": -1, "z": 0}},
  {"kind": "KIND_PULLED_BACK",
   "strength": 1.5,
   "center": {"x": 0, "y": 0.02, "z": -0.16},
   "radius_m": 0.18}],
 "bending_stiffness": 0.5,
 "colour": {"hue": {"normal": {"mean": 0.07, "deviation": 0.01, "low": 0, "high": 0.2}},
  "saturation": {"normal": {"mean": 0.55, "deviation": 0.06, "low": 0.3, "high": 0.8}},
  "value": {"normal": {"mean": 0.3, "deviation": 0.05, "low": 0.12, "high": 0.5}},
  "wisp_share": 0.5}}
)json"},
    {"parted_long", "Long wavy hair parted in the middle.",
     R"json(
{"seed": 7,
 "length": {"value": 0.48},
 "protrusion": {"value": 0.2},
 "member_length": {"normal": {"mean": 0.95, "deviation": 0.05, "low": 0.7, "high": 1}},
 "radii_m": [0.006, 0.01, 0.014, 0.008],
 "fuzziness": 0.08,
 "synthesis": {"prototype": {"kind": "STRAND_KIND_WAVY"}, "temperature": 0.1},
 "bending_stiffness": 0.4,
 "colour": {"hue": {"normal": {"mean": 0.07, "deviation": 0.01, "low": 0, "high": 0.2}},
  "saturation": {"normal": {"mean": 0.55, "deviation": 0.06, "low": 0.3, "high": 0.8}},
  "value": {"normal": {"mean": 0.3, "deviation": 0.05, "low": 0.12, "high": 0.5}},
  "wisp_share": 0.5},
 "operations": [{"region": {"half_spaces": [{"normal": {"x": 1, "y": 0, "z": 0}, "offset_m": 1e-06}]},
   "comb": {"path": [{"x": 0.005, "y": 0.16, "z": 0.04}, {"x": 0.06, "y": 0.145, "z": 0.03},
     {"x": 0.1, "y": 0.09, "z": 0.02}, {"x": 0.11, "y": 0.0, "z": 0.02}],
    "radius_m": 0.12,
    "weight": 0.7}},
  {"region": {"half_spaces": [{"normal": {"x": -1, "y": 0, "z": 0}, "offset_m": 0}]},
   "comb": {"path": [{"x": -0.005, "y": 0.16, "z": 0.04}, {"x": -0.06, "y": 0.145, "z": 0.03},
     {"x": -0.1, "y": 0.09, "z": 0.02}, {"x": -0.11, "y": 0.0, "z": 0.02}],
    "radius_m": 0.12,
    "weight": 0.7}}]}
)json"},
};

v1::ListStylePresetsResponse Parse() {
  v1::ListStylePresetsResponse response;
  for (const Preset& preset : kPresets) {
    v1::StylePreset* message = response.add_presets();
    message->set_name(preset.name);
    message->set_description(preset.description);
    const auto status =
        google::protobuf::util::JsonStringToMessage(preset.style, message->mutable_style());
    MANE_CHECK(status.ok());
  }
  return response;
}

}  // namespace

const v1::ListStylePresetsResponse& StylePresets() {
  static const v1::ListStylePresetsResponse presets = Parse();
  return presets;
}

}  // namespace mane::rpc
