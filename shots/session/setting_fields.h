// The fields of the settings, each once: functions name those of a structure (const or not) to a FieldReader or a
// FieldWriter.
#pragma once

#include <numbers>

#include "shots/session/view_settings.h"

namespace bodyopt::shots {

inline constexpr double kLatestFrame = 1e9;  // either way

inline constexpr auto kPlayingFields = [](auto& list, auto& playing) {
  list.choice("mode", playing.mode, kPlayModeNames);
  list.number("speed", playing.speed, PlaySettings::kSlowest, PlaySettings::kFastest);
  list.boolean("backwards", playing.backwards);
  list.boolean("real_time", playing.real_time);
  list.integer("in", playing.in, -kLatestFrame, kLatestFrame);
  list.integer("out", playing.out, -kLatestFrame, kLatestFrame);
};

inline constexpr auto kViewFields = [](auto& list, auto& view) {
  list.vector("target", view.target, -kFurthest, kFurthest);
  list.number("distance", view.distance, OrbitView::kNearest, OrbitView::kFarthest);
  list.number("azimuth", view.azimuth, -std::numbers::pi, std::numbers::pi);
  list.number("elevation", view.elevation, -std::numbers::pi / 2, std::numbers::pi / 2);
  list.boolean("orthographic", view.orthographic);
  list.boolean("cut_away", view.cut_away);
  // Earlier programs refuse these: files have them only where they say something.
  if (list.wants(view.roll != 0)) list.number("roll", view.roll, -std::numbers::pi, std::numbers::pi);
  if (list.wants(view.vertical_angle != OrbitView().vertical_angle)) {
    list.number("vertical_angle", view.vertical_angle, OrbitView::kNarrowest, OrbitView::kWidest);
  }
};

inline constexpr auto kShotCameraFields = [](auto& list, auto& camera) {
  list.boolean("look_through", camera.look_through);
  list.text("of_file", camera.of_file);
  list.by_frame("keys", camera.keys, [](auto& keys, const char* frame, auto& key) {
    keys.structure(frame, key, [](auto& fields, auto& camera_key) {
      kViewFields(fields, camera_key);
      fields.choice("ease", camera_key.ease, kKeyEaseNames);
    });
  });
};

inline constexpr auto kLookFields = [](auto& list, auto& look) {
  list.choice("style", look.style, kStyleNames);
  list.boolean("wire", look.wire);
  list.boolean("grid", look.grid);
  list.boolean("axes", look.axes);
  list.boolean("skeleton", look.skeleton);
  list.boolean("fibres", look.fibres);
  list.boolean("tets", look.tets);
  list.number("tet_cut", look.tet_cut, 0, 1);
  list.boolean("anatomy", look.anatomy);
  list.choice("anatomy_axis", look.anatomy_axis, kSectionAxisNames);
  list.number("anatomy_at", look.anatomy_at, 0, 1);
  list.boolean("shadow", look.shadow);
  list.boolean("worn", look.worn);
  list.boolean("follow", look.follow);
  list.integer("level", look.level, 0, kCoarsestLevel);
};

inline constexpr auto kCompareFields = [](auto& list, auto& compare) {
  list.choice("with", compare.with, kComparisonNames);
  list.choice("layout", compare.layout, kLayoutNames);
  list.number("wipe", compare.wipe, 0, 1);
  list.boolean("heat", compare.heat);
  list.number("heat_scale_mm", compare.heat_scale_mm, kFinestHeat, kCoarsestHeat);
  list.boolean("activation", compare.activation);
  list.boolean("coverage", compare.coverage);
  list.choice("match", compare.match, kMatchNames);
};

inline constexpr auto kPoseKeyFields = [](auto& list, auto& key) {
  list.named("joints", key.joints,
             [](auto& joints, const char* name, auto& angles) { joints.vector(name, angles, -kMostTurn, kMostTurn); });
  list.named("axes", key.axes,
             [](auto& axes, const char* name, auto& angle) { axes.number(name, angle, -kMostTurn, kMostTurn); });
  list.named("controls", key.controls, [](auto& controls, const char* name, auto& value) {
    controls.number(name, value, -kMostControl, kMostControl);
  });
  list.named("pins", key.pins,
             [](auto& pins, const char* name, auto& at) { pins.vector(name, at, -kFurthest, kFurthest); });
  // Earlier programs refuse these keys: files have them only where they say something.
  if (list.wants(!key.moves.empty())) {
    list.named("moves", key.moves,
               [](auto& moves, const char* name, auto& by) { moves.vector(name, by, -kFurthest, kFurthest); });
  }
  if (list.wants(key.ease != KeyEase::smooth)) list.choice("ease", key.ease, kKeyEaseNames);
  if (list.wants(!key.eases.empty())) {
    list.named("eases", key.eases,
               [](auto& eases, const char* name, auto& ease) { eases.choice(name, ease, kKeyEaseNames); });
  }
  if (list.wants(!key.facing.empty())) {
    list.named("facing", key.facing, [](auto& facing, const char* name, auto& angles) {
      facing.vector(name, angles, -kMostTurn, kMostTurn);
    });
  }
};

inline constexpr auto kPosingFields = [](auto& list, auto& pose) {
  list.number("correction", pose.correction, 0, 1);
  kPoseKeyFields(list, pose);
  list.by_frame("keys", pose.keys,
                [](auto& keys, const char* frame, auto& key) { keys.structure(frame, key, kPoseKeyFields); });
};

inline constexpr auto kJigglingFields = [](auto& list, auto& jiggle) {
  list.boolean("on", jiggle.on);
  list.number("amount", jiggle.amount, 0, kMostJiggle);
};

inline constexpr auto kGhostsFields = [](auto& list, auto& ghosts) {
  list.integer("before", ghosts.before, 0, kMostGhosts);
  list.integer("after", ghosts.after, 0, kMostGhosts);
  list.integer("step", ghosts.step, 1, kLongestGhostStep);
  list.number("opacity", ghosts.opacity, 0, 1);
  list.boolean("trail", ghosts.trail);
};

inline constexpr auto kCastFields = [](auto& list, auto& cast) {
  list.integer("copies", cast.copies, 1, kMostCopies);
  list.integer("delay", cast.delay, 0, kLongestCopyDelay);
};

inline constexpr auto kPlacementFields = [](auto& list, auto& placement) {
  list.vector("at", placement.at, -kFurthest, kFurthest);
  list.integer("ahead", placement.ahead, -kFurthestAhead, kFurthestAhead);
  list.integer("level", placement.level, 0, kCoarsestLevel);
};

inline constexpr auto kHudFields = [](auto& list, auto& hud) {
  list.boolean("on", hud.on);
  list.boolean("legend", hud.legend);
  list.named("panels", hud.panels, [](auto& panels, const char* name, auto& open) { panels.boolean(name, open); });
};

inline constexpr auto kSettingsFields = [](auto& list, auto& settings) {
  list.structure("playback", settings.playback, kPlayingFields);
  list.structure("camera", settings.camera, kViewFields);
  list.named("cameras", settings.cameras,
             [](auto& cameras, const char* name, auto& view) { cameras.structure(name, view, kViewFields); });
  // Earlier programs refuse it: files have it only where it says something.
  if (list.wants(settings.shot_camera != ViewSettings::ShotCamera())) {
    list.structure("shot_camera", settings.shot_camera, kShotCameraFields);
  }
  list.structure("look", settings.look, kLookFields);
  list.structure("compare", settings.compare, kCompareFields);
  list.structure("pose", settings.pose, kPosingFields);
  list.structure("jiggle", settings.jiggle, kJigglingFields);
  list.structure("ghosts", settings.ghosts, kGhostsFields);
  list.structure("cast", settings.cast, kCastFields);
  list.structure("hud", settings.hud, kHudFields);
};

}  // namespace bodyopt::shots
