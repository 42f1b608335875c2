#include "core/progress.h"

#include "core/error.h"

namespace underbody::core {

void Progress::check() const {
    if (cancelled()) {
        throw Cancelled();
    }
}

Progress& Progress::none() {
    static Progress silent;
    return silent;
}

}  // namespace underbody::core
