#include "convert.h"

namespace mane::inline client {

v1::Vector3 ToProto(const Vector3& v) {
  v1::Vector3 out;
  out.set_x(v.x);
  out.set_y(v.y);
  out.set_z(v.z);
  return out;
}

v1::Quaternion ToProto(const Quaternion& q) {
  v1::Quaternion out;
  out.set_x(q.x);
  out.set_y(q.y);
  out.set_z(q.z);
  out.set_w(q.w);
  return out;
}

v1::Pose ToProto(const Pose& pose) {
  v1::Pose out;
  *out.mutable_position() = ToProto(pose.position);
  *out.mutable_orientation() = ToProto(pose.orientation);
  return out;
}

v1::Guide ToProto(const Guide& guide) {
  v1::Guide out;
  *out.mutable_root_position() = ToProto(guide.root_position);
  *out.mutable_root_frame() = ToProto(guide.root_frame);
  out.set_length_m(guide.length_m);
  out.set_element_count(guide.element_count);
  out.mutable_element_lengths_m()->Assign(guide.element_lengths_m.begin(),
                                          guide.element_lengths_m.end());
  out.set_radius_1_m(guide.radius_1_m);
  out.set_radius_2_m(guide.radius_2_m);
  out.set_young_modulus_pa(guide.young_modulus_pa);
  out.set_poisson_ratio(guide.poisson_ratio);
  out.set_density_kg_m3(guide.density_kg_m3);
  out.set_internal_friction(guide.internal_friction);
  out.set_air_drag(guide.air_drag);
  out.mutable_natural_twist()->Assign(guide.natural_twist.begin(), guide.natural_twist.end());
  out.mutable_natural_curvature_1()->Assign(guide.natural_curvature_1.begin(),
                                            guide.natural_curvature_1.end());
  out.mutable_natural_curvature_2()->Assign(guide.natural_curvature_2.begin(),
                                            guide.natural_curvature_2.end());
  out.set_model(static_cast<v1::StrandModel>(guide.model));
  out.set_wisp_radius_m(guide.wisp_radius_m);
  return out;
}

v1::EllipsoidScalp ToProto(const EllipsoidScalp& scalp) {
  v1::EllipsoidScalp out;
  *out.mutable_center() = ToProto(scalp.center);
  *out.mutable_radii_m() = ToProto(scalp.radii_m);
  *out.mutable_cap_axis() = ToProto(scalp.cap_axis);
  out.set_cap_angle(scalp.cap_angle);
  return out;
}

v1::GuideGeneration ToProto(const GuideGeneration& generation) {
  v1::GuideGeneration out;
  out.set_hair_type(static_cast<v1::HairType>(generation.hair_type));
  out.set_guide_count(generation.guide_count);
  out.set_length_m(generation.length_m);
  out.set_element_count(generation.element_count);
  if (generation.error_target) out.set_error_target(*generation.error_target);
  out.set_seed(generation.seed);
  out.set_curl_variation(generation.curl_variation);
  out.set_root_droop(generation.root_droop);
  out.set_model(static_cast<v1::StrandModel>(generation.model));
  out.set_wisp_radius_m(generation.wisp_radius_m);
  return out;
}

v1::Environment ToProto(const Environment& environment) {
  v1::Environment out;
  if (environment.wind_velocity) {
    *out.mutable_wind_velocity() = ToProto(*environment.wind_velocity);
  }
  if (environment.gravity) *out.mutable_gravity() = ToProto(*environment.gravity);
  if (environment.internal_friction_scale) {
    out.set_internal_friction_scale(*environment.internal_friction_scale);
  }
  if (environment.air_drag_scale) out.set_air_drag_scale(*environment.air_drag_scale);
  if (environment.gust_strength) out.set_gust_strength(*environment.gust_strength);
  if (environment.gust_period_s) out.set_gust_period_s(*environment.gust_period_s);
  if (environment.turbulence_speed) out.set_turbulence_speed(*environment.turbulence_speed);
  if (environment.turbulence_size_m) out.set_turbulence_size_m(*environment.turbulence_size_m);
  if (environment.wind_seed) out.set_wind_seed(*environment.wind_seed);
  if (environment.detail_tolerance_m) {
    out.set_detail_tolerance_m(*environment.detail_tolerance_m);
  }
  return out;
}

v1::BeamMotion ToProto(const BeamMotion& beam) {
  v1::BeamMotion out;
  out.set_segments(beam.segments);
  if (beam.hold) out.set_hold(*beam.hold);
  out.set_equations(static_cast<v1::BeamEquations>(beam.equations));
  out.set_unbounded(beam.unbounded);
  if (beam.clamped) out.set_clamped(*beam.clamped);
  if (beam.avoid_head) out.set_avoid_head(*beam.avoid_head);
  if (beam.alpha) out.set_alpha(*beam.alpha);
  if (beam.near_m) out.set_near_m(*beam.near_m);
  out.mutable_epsilon()->Assign(beam.epsilon.begin(), beam.epsilon.end());
  out.mutable_largest_turn_rad()->Assign(beam.largest_turn_rad.begin(),
                                         beam.largest_turn_rad.end());
  out.set_fluctuation_rad(beam.fluctuation_rad);
  out.set_seed(beam.seed);
  if (beam.tip_response) out.set_tip_response(*beam.tip_response);
  return out;
}

v1::OpenHead ToProto(const HeadOptions& options) {
  v1::OpenHead out;
  out.set_groom(options.groom);
  out.set_pacing(static_cast<v1::Pacing>(options.pacing));
  out.set_format(static_cast<v1::FrameFormat>(options.format));
  out.set_space(static_cast<v1::Space>(options.space));
  out.set_points_per_guide(options.points_per_guide);
  out.set_rate_hz(options.rate_hz);
  out.set_substeps(options.substeps);
  out.set_diagnostics(options.diagnostics);
  out.set_pose_delay_s(options.pose_delay_s);
  out.set_max_unacked_frames(options.max_unacked_frames);
  *out.mutable_initial_pose() = ToProto(options.initial_pose);
  *out.mutable_environment() = ToProto(options.environment);
  out.set_model(static_cast<v1::AnimationModel>(options.model));
  *out.mutable_beam() = ToProto(options.beam);
  out.set_may_shed(options.may_shed);
  return out;
}

Pose FromProto(const v1::Pose& pose) {
  Pose out;
  out.position = {pose.position().x(), pose.position().y(), pose.position().z()};
  if (pose.has_orientation()) {
    const v1::Quaternion& q = pose.orientation();
    out.orientation = {q.x(), q.y(), q.z(), q.w()};
  }
  return out;
}

GroomInfo FromProto(const v1::Groom& groom) {
  GroomInfo out;
  out.name = groom.name();
  out.display_name = groom.display_name();
  out.create_time_s =
      static_cast<double>(groom.create_time().seconds()) + 1e-9 * groom.create_time().nanos();
  out.guide_count = groom.guide_count();
  out.element_count = groom.element_count();
  out.longest_guide_m = groom.longest_guide_m();
  out.hair_type = static_cast<HairType>(groom.hair_type());
  out.seed = groom.seed();
  out.etag = groom.etag();
  out.has_scalp = groom.has_scalp();
  if (groom.has_import_summary()) out.import_summary = FromProto(groom.import_summary());
  out.body_count = groom.body_count();
  for (const v1::BodySummary& body : groom.bodies()) out.bodies.push_back(FromProto(body));
  if (groom.has_scalp_contact()) out.scalp_contact = FromProto(groom.scalp_contact());
  out.hair_count = groom.hair_count();
  out.hair_point_count = groom.hair_point_count();
  return out;
}

void Merge(const Environment& change, Environment& environment) {
  if (change.wind_velocity) environment.wind_velocity = change.wind_velocity;
  if (change.gravity) environment.gravity = change.gravity;
  if (change.internal_friction_scale) {
    environment.internal_friction_scale = change.internal_friction_scale;
  }
  if (change.air_drag_scale) environment.air_drag_scale = change.air_drag_scale;
  if (change.gust_strength) environment.gust_strength = change.gust_strength;
  if (change.gust_period_s) environment.gust_period_s = change.gust_period_s;
  if (change.turbulence_speed) environment.turbulence_speed = change.turbulence_speed;
  if (change.turbulence_size_m) environment.turbulence_size_m = change.turbulence_size_m;
  if (change.wind_seed) environment.wind_seed = change.wind_seed;
  if (change.detail_tolerance_m) environment.detail_tolerance_m = change.detail_tolerance_m;
}

}  // namespace mane::inline client
