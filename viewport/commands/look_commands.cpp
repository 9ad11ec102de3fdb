// Cameras.
#include <filesystem>
#include <numbers>
#include <utility>

#include "base/wording.h"
#include "runtime/core/error.h"
#include "viewport/commands/commands.h"

namespace bodyopt::viewport {
namespace {

constexpr double kTurn = std::numbers::pi / 36;  // 5 degrees
constexpr double kMostPan = 100;

template <AxisView axis>
constexpr auto view_axis = [](Controls& c, const std::string&) {
  c.camera.view_axis(axis);
  c.requests.keep_framed = true;
};

shots::CameraKey& require_camera_key(Controls& c) {
  return require_key(c, c.settings.shot_camera.keys, " of the camera");
}

// Makes a switch of the view, as it is now.
template <bool shots::OrbitView::*member>
constexpr Command view_switch(const char* name, const char* key, const char* help) {
  constexpr auto run = [](OrbitCamera& camera, const std::string& a) {
    shots::OrbitView view = camera.view();
    toggle(view.*member, a);
    camera.look(view);
  };
  return {
      name, "[on|off]", key, "Camera", help, run, [](const Controls& c) { return name_of(c.camera.view().*member); }};
}

const Command kCameraCommands[] = {
    request_command<&Requests::frame_selection>("frame-selection", "F", "Camera",
                                                "see all of the character, or of the joint that is selected"),
    request_command<&Requests::frame_range>("frame-range", "Shift+F", "Camera",
                                            "see all, copies too, in every frame of the range"),
    {"front", "", "1", "Camera", "from the front", view_axis<AxisView::front>},
    {"back", "", "Ctrl+1", "Camera", "from behind", view_axis<AxisView::back>},
    {"right", "", "3", "Camera", "from the right of the picture: the character's left side",
     view_axis<AxisView::right>},
    {"left", "", "Ctrl+3", "Camera", "from the left of the picture: the character's right side",
     view_axis<AxisView::left>},
    {"top", "", "7", "Camera", "from above", view_axis<AxisView::top>},
    {"bottom", "", "Ctrl+7", "Camera", "from below", view_axis<AxisView::bottom>},
    view_switch<&shots::OrbitView::orthographic>("orthographic", "5", "without perspective, or with it"),
    view_switch<&shots::OrbitView::cut_away>("cut-away", "",
                                             "cuts away what stands before the point that the camera turns about"),
    switch_command<&shots::ViewSettings::Look::follow>("follow", "V", "Camera", "go along with the character"),
    {"orbit", "DEGREES DEGREES", "", "Camera", "around the target, to the right and up",
     [](OrbitCamera& camera, const std::string& a) {
       const auto w = words(a, 2, "two angles in degrees");
       camera.orbit(number(w[0]) * std::numbers::pi / 180, number(w[1]) * std::numbers::pi / 180);
     }},
    {"orbit-left", "", "Shift+Left", "Camera", "5 degrees to the left",
     [](OrbitCamera& camera, const std::string&) { camera.orbit(-kTurn, 0); }, nullptr, kRepeats},
    {"orbit-right", "", "Shift+Right", "Camera", "5 degrees to the right",
     [](OrbitCamera& camera, const std::string&) { camera.orbit(kTurn, 0); }, nullptr, kRepeats},
    {"pan", "RIGHT UP", "", "Camera", "the target, by shares of the picture's height",
     [](OrbitCamera& camera, const std::string& a) {
       const auto w = words(a, 2, "two shares of the picture's height");
       camera.pan(-number_within(w[0], -kMostPan, kMostPan), number_within(w[1], -kMostPan, kMostPan), 1);
     }},
    {"dolly", "NOTCHES", "", "Camera", "towards the target",
     [](OrbitCamera& camera, const std::string& a) { camera.dolly(number_within(a, -100, 100)); }},
    {"save-camera", "NAME", "", "Camera", "keeps the camera by a name",
     [](Controls& c, const std::string& a) {
       if (a.empty()) refuse(a, "a name");
       c.settings.cameras[a] = c.kept_camera();
     }},
    {"camera", "NAME", "", "Camera", "to a camera that was kept, or one of the lead's file",
     [](Controls& c, const std::string& a) {
       shots::ViewSettings::ShotCamera& shot = c.settings.shot_camera;
       const auto found = c.settings.cameras.find(a);
       if (found != c.settings.cameras.end()) {
         shot.of_file = "";
         return c.go_to_camera(found->second);
       }
       std::vector<std::string> names;
       for (const auto& [name, view] : c.settings.cameras) names.push_back(name);
       for (const ClipCamera& camera : c.file_cameras) names.push_back(camera.name);
       shot.of_file = known(a, names, "camera that was kept, or of the lead's file");
       shot.look_through = true;
       c.shot_frame.reset();
     }},
    {"forget-camera", "NAME", "", "Camera", "a camera that was kept",
     [](shots::ViewSettings& settings, const std::string& a) {
       if (settings.cameras.erase(a) == 0) refuse(a, "a camera that was kept");
     }},
    {"look-through", "[on|off]", "0", "Camera", "see by the camera of the shot, or freely",
     [](Controls& c, const std::string& a) {
       shots::ViewSettings::ShotCamera& shot = c.settings.shot_camera;
       toggle(shot.look_through, a);
       c.shot_frame.reset();
       if (shot.look_through && shot.keys.empty() && shot.of_file.empty())
         c.warn("the shot has no camera yet: 'camera-key' keys this view");
     },
     [](const Controls& c) { return name_of(c.settings.shot_camera.look_through); }},
    {"camera-key", "", "Alt+C", "Keys", "keeps the view as a key of the camera",
     [](Controls& c, const std::string&) {
       static_cast<shots::OrbitView&>(c.settings.shot_camera.keys[c.playback.frame()]) = c.kept_camera();
       c.settings.shot_camera.of_file = "";
       c.shot_frame = c.playback.frame();
     }},
    {"camera-unkey", "", "", "Keys", "forgets the camera's key of this frame",
     [](Controls& c, const std::string&) {
       require_camera_key(c);
       c.settings.shot_camera.keys.erase(c.playback.frame());
       c.shot_frame.reset();
     }},
    {"camera-ease", "smooth|linear|step|spline", "", "Keys", "from the camera's key here to the next; step: a cut",
     [](Controls& c, const std::string& a) { choose(require_camera_key(c).ease, a, shots::kKeyEaseNames); },
     [](const Controls& c) {
       const auto key = c.settings.shot_camera.keys.find(c.playback.frame());
       return name_of(key == c.settings.shot_camera.keys.end() ? shots::KeyEase::smooth : key->second.ease,
                      shots::kKeyEaseNames);
     }},
    {"move-camera-key", "FROM TO", "", "Keys", "the camera's key of a frame to another",
     [](Controls& c, const std::string& a) {
       if (move_key(c, c.settings.shot_camera.keys, a)) c.shot_frame.reset();
     }},
};

// Commands of the look.

constexpr const char* kImages = ".png|.jpg|.jpeg|.webp";

const Command kLookCommands[] = {
    choice_command<shots::kStyleNames, &shots::ViewSettings::Look::style>(
        "style", "clay|material|matcap|flat|normals|silhouette", "Look", "how skin looks"),
    {"next-style", "", "S", "Look", "clay, material, matcap, flat, normals, silhouette",
     [](shots::ViewSettings::Look& look, const std::string&) { choose_next(look.style, shots::kStyleNames); }},
    switch_command<&shots::ViewSettings::Look::wire>("wire", "W", "Look", "edges over the surface"),
    switch_command<&shots::ViewSettings::Look::skeleton>("skeleton", "K", "Look",
                                                         "joints and bones, seen through the skin"),
    switch_command<&shots::ViewSettings::Look::fibres>("fibres", "M", "Look", "muscle fibres, coloured by strain"),
    switch_command<&shots::ViewSettings::Look::tets>("tets", "T", "Look", "the tetrahedra of the jiggle, cut open"),
    {"tet-cut", "0-1", "", "Look", "share of the body that is cut away, from the front",
     [](shots::ViewSettings::Look& look, const std::string& a) { look.tet_cut = number_within(a, 0, 1); }},
    switch_command<&shots::ViewSettings::Look::anatomy>(
        "anatomy", "", "Look", "the lead cut open: bone, fat, cavity and muscles, named under the mouse"),
    choice_command<shots::kSectionAxisNames, &shots::ViewSettings::Look::anatomy_axis>(
        "anatomy-axis", "x|y|z", "Look", "of the world: what the cut is across"),
    {"anatomy-at", "0-1", "", "Look", "where the cut is, of the body's extent along that axis",
     [](shots::ViewSettings::Look& look, const std::string& a) { look.anatomy_at = number_within(a, 0, 1); }},
    {"level", "auto|0|1|2...", "", "Look", "of detail, 0 the finest; auto: the one that keeps up",
     [](shots::ViewSettings::Look& look, const std::string& a) {
       look.level = automatic_or(a, 0, shots::kCoarsestLevel, integer_within);
     }},
    switch_command<&shots::ViewSettings::Look::grid>("grid", "D", "Look", "the grid on the ground"),
    switch_command<&shots::ViewSettings::Look::axes>("axes", "A", "Look", "the world's axes"),
    switch_command<&shots::ViewSettings::Look::shadow>("shadow", "", "Look", "the shadow on the ground"),
    switch_command<&shots::ViewSettings::Look::worn>("worn", "", "Look",
                                                     "clothes, eyes and what else is attached to the skin"),
    {"image-plane", "[FILE|none] [0-1]", "", "Look", "an image behind, or one a frame (####); its opacity",
     [](Controls& c, const std::string& a) {
       if (a.empty()) return c.browse("image-plane");
       if (a == "none") return void(c.image_plane = {});
       shots::ImagePlaneFile plane{a};
       if (!missing_ending(a, kImages).empty()) {
         const auto [file, opacity] = split_last(a, "a file that ends in .png, .jpg or .webp, and an opacity");
         require_ending(file, kImages);
         plane = {file, number_within(opacity, 0, 1)};
       }
       const bool is_sequence = plane.file.find_first_of("#%") != std::string::npos;
       std::error_code absent;
       if (!is_sequence && !std::filesystem::exists(plane.file, absent)) refuse(plane.file, "a file that is there");
       c.image_plane = plane;
     }},
};

}  // namespace

std::span<const Command> camera_commands() { return kCameraCommands; }

std::span<const Command> look_commands() { return kLookCommands; }

}  // namespace bodyopt::viewport
