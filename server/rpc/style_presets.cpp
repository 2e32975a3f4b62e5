#include "rpc/style_presets.h"

#include <google/protobuf/util/json_util.h>

#include "base/check.h"
#include "rpc/beam_presets.h"

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
 "length": {"value": 0.4,
  "by_azimuth": [{"at": -3.1, "value": 0.8}, {"at": -1.5, "value": 0.9}, {"at": 0, "value": 1},
   {"at": 1.5, "value": 0.9}, {"at": 3.1, "value": 0.8}]},
 "protrusion": {"value": 0.15},
 "member_length": {"normal": {"mean": 0.95, "deviation": 0.05, "low": 0.7, "high": 1}},
 "radii_m": [0.006, 0.006, 0.007, 0.007],
 "fuzziness": 0.05,
 "bending_stiffness": 0.3,
 "colour": {"hue": {"normal": {"mean": 0.07, "deviation": 0.01, "low": 0, "high": 0.2}},
  "saturation": {"normal": {"mean": 0.55, "deviation": 0.06, "low": 0.3, "high": 0.8}},
  "value": {"normal": {"mean": 0.3, "deviation": 0.05, "low": 0.12, "high": 0.5}},
  "wisp_share": 0.5},
 "queues": [{"name": "bun",
   "constraints": [{"kind": "KIND_POINT", "path": [{"x": 0.0, "y": 0.091, "z": -0.09}], "radius_m": 0.014},
    {"kind": "KIND_TRAJECTORY",
     "path": [{"x": 0.0, "y": 0.091, "z": -0.09}, {"x": 0.0141, "y": 0.0875, "z": -0.0906},
      {"x": 0.0254, "y": 0.0789, "z": -0.0913}, {"x": 0.0323, "y": 0.0666, "z": -0.0919},
      {"x": 0.0337, "y": 0.0529, "z": -0.0926}, {"x": 0.0296, "y": 0.0399, "z": -0.0932},
      {"x": 0.0208, "y": 0.0298, "z": -0.0939}, {"x": 0.009, "y": 0.0241, "z": -0.0945},
      {"x": -0.004, "y": 0.0236, "z": -0.0952}, {"x": -0.0158, "y": 0.0283, "z": -0.0958},
      {"x": -0.0247, "y": 0.0371, "z": -0.0965}, {"x": -0.0292, "y": 0.0485, "z": -0.0972},
      {"x": -0.0289, "y": 0.0605, "z": -0.0978}, {"x": -0.0239, "y": 0.0712, "z": -0.0984},
      {"x": -0.0152, "y": 0.0789, "z": -0.0991}, {"x": -0.0043, "y": 0.0824, "z": -0.0997},
      {"x": 0.0068, "y": 0.0813, "z": -0.1004}, {"x": 0.0163, "y": 0.0761, "z": -0.1011},
      {"x": 0.0229, "y": 0.0676, "z": -0.1017}, {"x": 0.0254, "y": 0.0574, "z": -0.1023},
      {"x": 0.0238, "y": 0.0473, "z": -0.103}, {"x": 0.0183, "y": 0.0388, "z": -0.1036},
      {"x": 0.0102, "y": 0.0334, "z": -0.1043}, {"x": 0.0007, "y": 0.0317, "z": -0.1049},
      {"x": -0.0084, "y": 0.0338, "z": -0.1056}, {"x": -0.0157, "y": 0.0393, "z": -0.1062},
      {"x": -0.0202, "y": 0.047, "z": -0.1069}, {"x": -0.0211, "y": 0.0557, "z": -0.1075},
      {"x": -0.0186, "y": 0.0638, "z": -0.1082}, {"x": -0.0133, "y": 0.07, "z": -0.1089},
      {"x": -0.006, "y": 0.0735, "z": -0.1095}, {"x": 0.0018, "y": 0.0739, "z": -0.1101},
      {"x": 0.0089, "y": 0.0711, "z": -0.1108}, {"x": 0.0141, "y": 0.0659, "z": -0.1114},
      {"x": 0.0168, "y": 0.0593, "z": -0.1121}, {"x": 0.0165, "y": 0.0524, "z": -0.1127},
      {"x": 0.0137, "y": 0.0463, "z": -0.1134}, {"x": 0.0088, "y": 0.0421, "z": -0.114},
      {"x": 0.0028, "y": 0.0402, "z": -0.1147}, {"x": -0.0032, "y": 0.0408, "z": -0.1153},
      {"x": -0.0082, "y": 0.0437, "z": -0.116}],
     "radius_m": 0.01}]}]}
)json"},
    {"three-strand-braid", "Long hair gathered at the nape and braided down the back.",
     R"json(
{"seed": 7,
 "length": {"value": 0.66},
 "protrusion": {"value": 0.2},
 "member_length": {"normal": {"mean": 0.97, "deviation": 0.02, "low": 0.9, "high": 1}},
 "radii_m": [0.006, 0.007, 0.011, 0.008],
 "fuzziness": 0.04,
 "bending_stiffness": 0.3,
 "colour": {"hue": {"normal": {"mean": 0.045, "deviation": 0.008, "low": 0, "high": 0.1}},
  "saturation": {"normal": {"mean": 0.7, "deviation": 0.06, "low": 0.4, "high": 0.9}},
  "value": {"normal": {"mean": 0.45, "deviation": 0.06, "low": 0.2, "high": 0.7}},
  "wisp_share": 0.5},
 "segment_length_m": 0.008,
 "operations": [{"braid": {"path": [{"x": 0, "y": 0.01, "z": -0.1}, {"x": 0, "y": -0.1, "z": -0.125},
     {"x": 0, "y": -0.27, "z": -0.14}],
    "strand_count": 3,
    "radius_m": 0.022,
    "period_m": 0.11}}]}
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
  "wisp_share": 0.4},
 "wisp_count": 1000}
)json"},
    {"pulled-back", "Hair combed back over the head and down to the neck.",
     R"json(
{"seed": 7,
 "length": {"value": 0.3},
 "protrusion": {"value": 0.25},
 "member_length": {"normal": {"mean": 0.95, "deviation": 0.05, "low": 0.7, "high": 1}},
 "radii_m": [0.006, 0.009, 0.006],
 "fuzziness": 0.05,
 "field": [{"kind": "KIND_UNIFORM", "strength": 0.7, "direction": {"x": 0, "y": -1, "z": 0}},
  {"kind": "KIND_UNIFORM",
   "strength": 2,
   "direction": {"x": 0, "y": 0.05, "z": -1},
   "center": {"x": 0, "y": 0.09, "z": 0.05},
   "radius_m": 0.085}],
 "bending_stiffness": 0.5,
 "colour": {"hue": {"normal": {"mean": 0.07, "deviation": 0.01, "low": 0, "high": 0.2}},
  "saturation": {"normal": {"mean": 0.55, "deviation": 0.06, "low": 0.3, "high": 0.8}},
  "value": {"normal": {"mean": 0.3, "deviation": 0.05, "low": 0.12, "high": 0.5}},
  "wisp_share": 0.5}}
)json"},
    {"parted-long", "Long wavy hair parted in the middle.",
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
  AddBeamPresets(&response);
  return response;
}

}  // namespace

const v1::ListStylePresetsResponse& StylePresets() {
  static const v1::ListStylePresetsResponse presets = Parse();
  return presets;
}

}  // namespace mane::rpc
