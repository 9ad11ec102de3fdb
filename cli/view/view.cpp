// bodyopt view: the animators' viewport.
#include "cli/view/view.h"

#include <set>
#include <sstream>

#include "cli/arguments/common.h"
#include "draw/canvas.h"
#include "runtime/core/error.h"
#include "viewport/commands/commands.h"
#include "viewport/picture_files.h"
#include "viewport/viewer.h"

namespace bodyopt::cli {
namespace {

struct ViewArguments {
  viewport::ViewerOptions options;
  std::vector<std::uint32_t> size;
  bool no_vsync = false;
};

// Does the script leave a file?
bool writes(const std::string& script) {
  const std::set<std::string> writing = {"screenshot",   "sequence",    "turntable",   "save",      "save-state",
                                         "save-markers", "export-clip", "export-skin", "stroke",    "keep-strokes",
                                         "save-pose",    "modifier",    "strength",    "undo-edit", "redo-edit"};
  for (const std::string& command : viewport::script_commands(script)) {
    std::string name;
    std::istringstream(command) >> name;
    if (writing.contains(name)) return true;
  }
  return false;
}

void run(const ViewArguments& arguments) {
  viewport::ViewerOptions options = arguments.options;
  if (!arguments.size.empty()) {
    options.width = arguments.size[0];
    options.height = arguments.size[1];
  }
  options.vsync = !arguments.no_vsync;
  if (!options.out.empty() && !options.headless) {
    throw Error(ErrorKind::usage, "-o writes pictures without a window: it needs --headless");
  }
  if (!options.out.empty()) viewport::require_picture_name(options.out, true);
  if (options.headless && options.out.empty() && !writes(options.commands)) {
    throw Error(ErrorKind::usage,
                "--headless shows nothing: give it -o FILE.png, or --do with a command that writes, as screenshot or "
                "sequence");
  }
  options.device.require_device = true;
  options.device.pipeline_cache = cache_folder();
  if (!options.headless) options.user_folder = cache_folder().string();
  viewport::run_viewer(options);
}

}  // namespace

void add_view(CLI::App& app) {
  const auto [verb, arguments] = add_verb<ViewArguments>(app, "view", "Open the animators' viewport", run);
  viewport::ViewerOptions& options = arguments.options;
  add_option(
      verb, "files", options.files, "BASIS|CHARACTER|DATASET [CLIP]",
      "Basis (.safetensors), or character (.glb, .gltf, .fbx) by Direct Delta Mush, its clip and point cache, or "
      "a dataset; "
      "then others, each followed by its own (default: the built-in arm)");
  add_option(verb, "--truth", options.truth, "CACHE",
             "Point cache to compare the first character with, or DATASET#TAKE: a take through its modifiers");
  add_option(verb, "--proxy", options.proxy, "BASIS", "Lighter levels of the first basis, which `proxy` made of it");
  add_option(verb, "--character", options.character, "CHARACTER",
             "File of the first basis' character, to compare with linear blending");
  add_option(verb, "--ff", options.first, "First frame of the range that is played")->type_name("FRAME");
  add_option(verb, "--lf", options.last, "Last frame")->type_name("FRAME");
  add_option(verb, "--cf", options.current, "Frame to begin at")->type_name("FRAME");
  add_option(verb, "--fps", options.clip.fps, "Frames a second that clips are sampled at (default: 24)")
      ->check(above_zero);
  add_option(verb, "--size", arguments.size, "Width and height of the picture, pixels")
      ->expected(2)
      ->allow_extra_args(false)
      ->check(CLI::Range(1u, draw::kMostCanvasPixels));
  add_option(verb, "--limits", options.limits, "FILE",
             "Joint limits (limits.json) of the first character: how far joints can be turned");
  add_option(verb, "--muscles", options.muscles, "FILE",
             "Muscles (muscles.json) of the first character, to be told apart where it is cut open");
  add_retargeting(verb, options.joint_map, options.up);
  add_option(verb, "--state", options.state, "Cameras and settings that the viewport saved")->type_name("FILE");
  add_option(verb, "--do", options.commands, "Commands of the viewport, parted by ';'")->type_name("COMMANDS");
  add_unit(verb, options.clip.unit);
  add_option(verb, "--live", options.live_port, "Show poses that another program sends to this UDP port of 127.0.0.1")
      ->type_name("PORT")
      ->check(CLI::Range(0, 65535));
  add_flag(verb, "--no-vsync", arguments.no_vsync, "As many pictures a second as there can be");
  add_option(verb, "--seconds", options.seconds, "Close after so long")->check(above_zero);
  add_flag(verb, "--headless", options.headless, "Without a window");
  add_option(verb, "-o,--out", options.out, "FILE",
             "With --headless: a picture (.png), one per frame where the name has #### or %04d, or all frames in "
             "a movie (.webp, .mp4)");
  add_option(verb, "--device", options.device.name, "Vulkan device: auto, an index or part of a name (default: auto)");
  add_flag(verb, "--validate", options.device.validation, "With Vulkan's validation layers: any message is an error");
}

}  // namespace bodyopt::cli
