// modifiers/history.json: the stacks that a dataset had, for undo and redo.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <vector>

#include "dataset/dataset.h"
#include "runtime/core/file_lock.h"

namespace bodyopt {

// `path`: the dataset.json. All of these hold its lock, and rename dataset.json into place last: killed at any moment,
// it is the old one or the new one, and the history fits either. Each returns the dataset as it is then.

// Replaces the stack by what `edit` makes of it; what `edit` throws leaves all as it was. `patience`: with others that
// edit.
Dataset edit_modifiers(const std::filesystem::path& path,
                       const std::function<void(const Dataset& dataset, std::vector<Modifier>& modifiers)>& edit,
                       std::chrono::milliseconds patience = kPatienceForChanges);
// Back to the stack before the last edit, and forth again. Throws Error(usage) where there is none.
Dataset undo_modifiers(const std::filesystem::path& path, std::chrono::milliseconds patience = kPatienceForChanges);
Dataset redo_modifiers(const std::filesystem::path& path, std::chrono::milliseconds patience = kPatienceForChanges);

// Calls `look` with the dataset and all stacks that undo and redo lead to, its own among them, while nobody edits.
// `forget`: the others are given up first.
void look_at_stacks(
    const std::filesystem::path& path, bool forget,
    const std::function<void(const Dataset& dataset, const std::vector<std::vector<Modifier>>& stacks)>& look);

}  // namespace bodyopt
