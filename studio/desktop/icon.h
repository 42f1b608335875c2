// The program's icon, drawn: a flat-bottomed body over the ground.
#pragma once

#include <QIcon>

namespace underbody::studio {

QIcon program_icon();

}  // namespace underbody::studio
