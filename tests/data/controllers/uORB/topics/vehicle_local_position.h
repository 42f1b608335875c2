#pragma once
#include <stdint.h>
struct orb_metadata;
extern const orb_metadata __orb_vehicle_local_position;
struct vehicle_local_position_s {
    uint64_t timestamp; float vx; float vy; float vz; bool v_z_valid;
};
