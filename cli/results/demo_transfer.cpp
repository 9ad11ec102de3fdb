#include "cli/results/demo_transfer.h"

#include "cli/results/transfer_page.h"
#include "report/page.h"
#include "runtime/core/atomic_file.h"
#include "trainer/builtin/arm.h"
#include "trainer/transfer/likeness.h"
#include "trainer/transfer/transfer_basis.h"

namespace bodyopt::cli {
namespace {

namespace fs = std::filesystem;

constexpr int kFrameStep = 6;  // of the held-out clip

void write_page(const TransferPair& pair, const Basis& carried, const fs::path& folder) {
  const Clip clip = read_clip((folder / "heldout.glb").string(), pair.source.skeleton, {});
  std::vector<int> frames;
  for (int frame = clip.first_frame; frame <= clip.last_frame(); frame += kFrameStep) frames.push_back(frame);
  const std::vector<ComparedPose> poses = compare_poses(pair, carried, clip, frames);
  Json target = {{"target", "stocky.glb"}, {"vertices", carried.mesh.vertex_count()}};
  target.update(to_json(pair, likeness(pair)));
  target.update(to_json(transfer_parts(pair.source, pair.target, pair.match, pair.correspondence), poses));
  const Json figures = {{"title", "A stockier arm"},
                        {"subtitle", "What the built-in arm learned, on one of thicker flesh and other triangles"},
                        {"targets", Json::array({target})}};
  const std::string page = page_text("transfer", figures, Json::array({transfer_pictures(pair, carried.mesh, poses)}));
  write_file_atomically(folder / "transfer.html", std::as_bytes(std::span(page)));
}

}  // namespace

std::string demo_transfer(const fs::path& folder, bool has_pictures) {
  write_character(build_stocky_arm(), folder / "stocky.glb");
  const Character stocky = read_character(folder / "stocky.glb");
  const Basis source = load_basis(folder / "basis.safetensors");
  const TransferOptions options;
  const TransferPair pair(source, stocky, options);
  std::vector<std::string> notes;
  const Basis carried = transfer_basis(pair, options, notes);
  say(notes);
  save_basis(carried, folder / "stocky.safetensors");
  if (has_pictures) write_page(pair, carried, folder);
  return format("carried to a stockier arm of {} vertices (this one: {}), matched with a confidence of {:.2f}\n",
                carried.mesh.vertex_count(), source.mesh.vertex_count(), pair.correspondence.mean_confidence());
}

}  // namespace bodyopt::cli
