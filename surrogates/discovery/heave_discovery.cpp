#include "surrogates/discovery/discovery.h"

namespace underbody::discovery {

Discovery discover_time_series(const dynamics::Model&, const dynamics::Measurements& data, const DiscoverOptions&, core::Progress&) {
    throw core::InputError("kind", "time series are not read yet", core::Place{data.folder.string(), {}, {}, {}});
}

}  // namespace underbody::discovery
