// Texts in command lines that a queue hands to a shell.
#pragma once

#include <string>

namespace bodyopt {

// A text as one word for sh: nothing in it has a meaning.
std::string quoted_for_shell(const std::string& text);

}  // namespace bodyopt
