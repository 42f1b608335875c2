#pragma once
#include <stdint.h>
struct orb_metadata;
extern const orb_metadata __orb_vehicle_thrust_setpoint;
struct vehicle_thrust_setpoint_s {
    uint64_t timestamp; uint64_t timestamp_sample; float xyz[3];
};
