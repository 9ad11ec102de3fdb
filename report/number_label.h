// Numbers written on pictures.
#pragma once

#include "draw/png.h"

namespace bodyopt {

// White digits on a dark plate around the pixel (x, y), shifted as far as it takes to stay inside the picture.
void draw_number(Image& image, int number, int x, int y);

}  // namespace bodyopt
