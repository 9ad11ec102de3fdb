// Files that are chosen from the list of a folder.
#include "viewport/state/file_dialog.h"

#include <fstream>

#include "shots/session/session_file.h"
#include "tests/support/error_kind.h"
#include "tests/viewport/played_viewport.h"
#include "viewport/commands/commands.h"

namespace bodyopt::testing {
namespace {

using namespace shots;
using namespace viewport;

TEST(FileDialog, ListsFoldersAndTheFilesThatTheCommandKnows) {
  const TemporaryFolder folder;
  for (const char* file : {"walk.bvh", "Arm.GLB", "notes.txt", ".hidden.bvh", "session.json"}) {
    std::ofstream(folder / file) << "x";
  }
  std::filesystem::create_directory(folder / "shots");
  std::ofstream(folder / "shots" / "a.bvh") << "x";
  using Entries = std::vector<FolderEntry>;
  const FileDialog dialog = browse_folder("export-clip", folder.path(), "walk.bvh");
  EXPECT_EQ(dialog.entries, (Entries{{"..", true}, {"shots", true}, {"Arm.GLB", false}, {"walk.bvh", false}}));
  EXPECT_TRUE(dialog.replaces());
  EXPECT_EQ(dialog.file(), (folder / "walk.bvh").string());
  EXPECT_FALSE(browse_folder("export-clip", folder.path(), "run.bvh").replaces());
  EXPECT_EQ(browse_folder("save", folder.path()).entries,
            (Entries{{"..", true}, {"shots", true}, {"session.json", false}}));
  const FileDialog inner = browse_folder("open", folder / "shots");
  EXPECT_EQ(inner.entries, (Entries{{"..", true}, {"a.bvh", false}}));
  EXPECT_EQ(browse_folder("open", inner.folder / "..").folder, folder.path() / "");
}

TEST(FileDialog, SaysWhatCannotBeListed) {
  const TemporaryFolder folder;
  EXPECT_EQ(kind_of([&] { browse_folder("open", folder / "none"); }), ErrorKind::file);
  EXPECT_EQ(kind_of([&] { browse_folder("play", folder.path()); }), ErrorKind::usage);
}

TEST(FileDialog, IsOfTheCommandsThatTakeAFile) {
  const std::vector<std::string> choices = choices_of(*find_command("browse"));
  for (const std::string& command : browsed_commands()) {
    EXPECT_NE(find_command(command), nullptr) << command;
    EXPECT_NE(std::ranges::find(choices, command), choices.end()) << command;
  }
  EXPECT_EQ(choices.size(), browsed_commands().size());
}

class FileDialogTest : public PlayedTest {};

// Letters are of the name alone, from the first: others would be commands.
TEST_F(FileDialogTest, NoLetterOfANameIsACommand) {
  const auto viewport = open();
  viewport->key("Ctrl+S");
  viewport->key("H");
  viewport->key("W");
  EXPECT_FALSE(viewport->controls().cheat_sheet || viewport->controls().settings.look.wire);
  viewport->key("Escape");
}

// Only a session gives way to one.
TEST_F(FileDialogTest, OtherFilesAreNotReplacedByASession) {
  const auto viewport = open();
  viewport->prompt("save-state look.json");
  viewport->prompt("save look.json");
  EXPECT_FALSE(is_session("look.json"));
  EXPECT_NE(viewport->controls().messages.back().text.find("is no session"), std::string::npos);
}

TEST_F(FileDialogTest, ANameThatIsTypedIsThatOfTheFile) {
  const auto viewport = open();
  viewport->prompt("browse save");
  ASSERT_TRUE(viewport->controls().dialog);
  viewport->type("shot.json");
  EXPECT_EQ(viewport->controls().dialog->name, "shot.json");
  viewport->key("Enter");
  EXPECT_FALSE(viewport->controls().dialog);
  EXPECT_TRUE(std::filesystem::exists("shot.json"));
  viewport->prompt("browse open");
  viewport->key("Escape");
  EXPECT_FALSE(viewport->controls().dialog);
}

}  // namespace
}  // namespace bodyopt::testing
