// bodyopt export: a draft's nodes to a point cache that other programs read.
#include <nlohmann/json.hpp>

#include "assets/caches/nodes_cache.h"
#include "assets/caches/pc2.h"
#include "cli/arguments/common.h"

namespace bodyopt::cli {
namespace {

struct ExportArguments {
  std::string draft, out;
  CacheSpace space;
  JsonOption json;
};

void run(const ExportArguments& arguments) {
  arguments.json.require_writable();
  const NodesReader draft(arguments.draft);
  Pc2Writer writer(arguments.out, draft.point_count(), draft.sample_count(), draft.start_frame(), draft.sample_rate(),
                   arguments.space);
  for (std::uint32_t k = 0; k < draft.sample_count(); ++k) writer.append(draft.sample(k));
  writer.close();
  arguments.json.emit(
      {{"out", arguments.out}, {"points", draft.point_count()}, {"samples", draft.sample_count()}},
      format("wrote {}: {} points, {} samples\n", arguments.out, draft.point_count(), draft.sample_count()));
}

}  // namespace

void add_export(CLI::App& app) {
  const auto [verb, arguments] =
      add_verb<ExportArguments>(app, "export", "Write a draft's skin as a point cache for other programs", run);
  add_required(verb, "draft", arguments.draft, "DRAFT", "Nodes of a draft (.nodes)");
  add_option(verb, "--out", arguments.out, "FILE.pc2|.mdd", "Point cache to write")->required();
  add_cache_space(verb, arguments.space);
  arguments.json.add(verb);
}

}  // namespace bodyopt::cli
