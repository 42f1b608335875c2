#include "studio/figures/render.h"
