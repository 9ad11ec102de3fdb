#include "proxy_viewer/panels/shown_texts.h"

namespace bodyopt {

void visit_texts(const Snapshot& snapshot, const Controls& controls,
                 const std::function<void(const std::string&)>& visit) {
  for (const CharacterRow& row : snapshot.cast) {
    for (const std::string* text : {&row.name, &row.basis, &row.clip, &row.truth}) visit(*text);
  }
  for (const JointRow& row : snapshot.joints) visit(row.name);
  for (const ControlRow& row : snapshot.controls) visit(row.name);
  for (const std::string& fibre : snapshot.fibres) visit(fibre);
  if (snapshot.curation) {
    for (const StackRow& row : snapshot.curation->modifiers) visit(row.name);
    for (const PoseDot& dot : snapshot.curation->dots) visit(dot.text);
    for (const std::string& pair : snapshot.curation->pairs) visit(pair);
    for (const std::string& region : controls.curating.regions) visit(region);
  }
  visit(snapshot.outside_feature);
  visit(snapshot.device);
  for (const auto& [name, view] : controls.settings.cameras) visit(name);
  const PanelState& typed = controls.typed;
  for (const std::string* text : {&typed.prompt, &typed.joint_filter, &typed.camera, &typed.open, &typed.screenshot,
                                  &typed.sequence, &typed.turntable, &typed.state}) {
    visit(*text);
  }
  visit(controls.brush.modifier);
  if (controls.dialog) {
    visit(controls.dialog->folder.string());
    visit(controls.dialog->name);
    for (const FolderEntry& entry : controls.dialog->entries) visit(entry.name);
  }
  for (const Message& message : controls.messages) visit(message.text);
}

}  // namespace bodyopt
