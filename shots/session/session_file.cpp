#include "shots/session/session_file.h"

#include <nlohmann/json.hpp>
#include <set>

#include "assets/clips/clip_source.h"
#include "base/json_fields.h"
#include "runtime/basis/attachments.h"
#include "runtime/basis/dynamics.h"
#include "runtime/basis/levels.h"
#include "runtime/core/error.h"
#include "shots/session/setting_fields.h"

namespace bodyopt::shots {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSessionSchema = "bodyopt-session-1";
constexpr double kHighestRate = 1000, kLargestUnit = 1e6;

constexpr auto kFileFields = [](auto& list, auto& files) {
  list.text("basis", files.basis);
  list.text("clip", files.clip);
  list.text("truth", files.truth);
  list.text("proxy", files.proxy);
  list.text("character", files.character);
  list.text("limits", files.limits);
  list.text("muscles", files.muscles);
  list.text("joint_map", files.joint_map);
  list.text("up", files.up);
};

constexpr int kHighestNumber = 1000000;  // of one of the cast

constexpr auto kCharacterFields = [](auto& list, auto& character) {
  kFileFields(list, character.files);
  list.structure("pose", character.pose, kPosingFields);
  kPlacementFields(list, character.placement);
  if (list.wants(character.number != 0)) list.integer("number", character.number, 1, kHighestNumber);
};

// Numbers are their own: whoever has none, or another's, gets that of its place, or the first that is free. A list in
// that order has none, for earlier programs refuse them.
void give_numbers(std::vector<SessionCharacter>& cast) {
  std::set<int> given;
  for (std::size_t k = 0; k < cast.size(); ++k) {
    int& number = cast[k].number;
    if (number == 0) number = static_cast<int>(k) + 1;
    for (int free = 1; !given.insert(number).second; ++free) number = free;
  }
}

void drop_numbers(std::vector<SessionCharacter>& cast) {
  for (std::size_t k = 0; k < cast.size(); ++k) {
    if (cast[k].number != static_cast<int>(k) + 1) return;
  }
  for (SessionCharacter& character : cast) character.number = 0;
}

constexpr auto kSessionFields = [](auto& list, auto& session) {
  list.number("fps", session.clip.fps, 1e-3, kHighestRate);
  list.number("unit", session.clip.unit, 0, kLargestUnit);
  list.structures("characters", session.cast, kCharacterFields);
  list.integer("frame", session.frame, -kLatestFrame, kLatestFrame);
  list.text("joint", session.joint);
  list.text("saved_as", session.saved_as);
  list.structure("view", session.view, kSettingsFields);
  // Earlier programs refuse these: files have them only where there are any.
  constexpr bool writes = std::is_const_v<std::remove_reference_t<decltype(session)>>;
  if (!writes || !session.image_plane.file.empty()) {
    list.structure("image_plane", session.image_plane, [](auto& fields, auto& plane) {
      fields.text("file", plane.file);
      fields.number("opacity", plane.opacity, 0, 1);
    });
  }
  if (!writes || !session.sound.file.empty()) {
    list.structure("sound", session.sound, [](auto& fields, auto& sound) {
      fields.text("file", sound.file);
      fields.integer("first", sound.first, -kLatestFrame, kLatestFrame);
    });
  }
};

// Changes each path; empty ones stay so.
template <typename Change>
void change_paths(SessionFile& session, const Change& change) {
  for (std::string* file : {&session.image_plane.file, &session.sound.file}) {
    if (!file->empty()) *file = change(fs::path(*file)).string();
  }
  for (SessionCharacter& character : session.cast) {
    ActorFiles& f = character.files;
    for (std::string* file :
         {&f.basis, &f.clip, &f.truth, &f.proxy, &f.character, &f.limits, &f.muscles, &f.joint_map}) {
      if (!file->empty()) *file = change(fs::path(*file)).string();
    }
  }
}

bool lies_within(const fs::path& relative) { return relative.is_relative() && *relative.begin() != ".."; }

}  // namespace

namespace fs = std::filesystem;

bool is_basis(const std::string& path) { return path.ends_with(".safetensors"); }

fs::path ActorFiles::dynamics() const { return dynamics_beside(basis); }

fs::path ActorFiles::attached() const { return attachments_beside(basis); }

fs::path ActorFiles::levels() const { return proxy.empty() && is_basis(basis) ? proxy_beside(basis) : fs::path(proxy); }

std::string ActorFiles::up_of(const std::string& source) const {
  return lower_case_extension(split_source(source).path) == ".bvh" ? up : "";
}

std::string ActorFiles::own_file() const {
  if (!character.empty()) return character;
  if (!is_basis(basis)) return basis;
  for (const char* extension : {".glb", ".gltf", ".vrm", ".fbx"}) {
    const fs::path beside = fs::path(basis).replace_extension(extension);
    if (fs::exists(beside)) return beside.string();
  }
  return "";
}

std::vector<fs::path> ActorFiles::paths() const {
  std::vector<fs::path> all;
  if (is_basis(basis)) all = {dynamics(), attached()};
  for (const std::string& file : {basis, split_source(clip).path.string(), truth, levels().string(),
                                  is_basis(basis) ? own_file() : character, limits, muscles, joint_map}) {
    if (!file.empty()) all.emplace_back(file);
  }
  return all;
}

bool is_session(const std::string& file) {
  try {
    read_json(file, kSessionSchema);
    return true;
  } catch (const Error&) {
    return false;
  }
}

SessionFile read_session(const fs::path& path) {
  Json json = read_json(path, kSessionSchema);
  json.erase("schema");
  SessionFile session;
  FieldReader reader(json, path, "the file");
  kSessionFields(reader, session);
  reader.finish();
  if (session.cast.empty()) {
    throw Error(ErrorKind::file, path.string() + ": 'characters' is empty or missing, expected at least one");
  }
  require_good_settings(session.view, path);
  session.cast.front().pose = session.view.pose;
  give_numbers(session.cast);
  const fs::path folder = path.parent_path();
  change_paths(session, [&](const fs::path& file) { return (folder / file).lexically_normal(); });
  return session;
}

void write_session(const SessionFile& session, const fs::path& path) {
  SessionFile kept = session;
  const fs::path folder = fs::absolute(path).parent_path();
  change_paths(kept, [&](const fs::path& file) {
    const fs::path relative = fs::absolute(file).lexically_normal().lexically_proximate(folder.lexically_normal());
    return file.is_relative() || lies_within(relative) ? relative : file;
  });
  if (!kept.cast.empty()) kept.cast.front().pose = {};
  drop_numbers(kept.cast);
  FieldWriter writer;
  kSessionFields(writer, kept);
  Json json = {{"schema", kSessionSchema}};
  json.update(writer.json());
  write_json(json, path);
}

}  // namespace bodyopt::shots
