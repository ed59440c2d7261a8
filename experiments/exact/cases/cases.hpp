// The exact cases by family; catalog.cpp puts them into one list.
#pragma once

#include "experiments/exact/cases/exact_case.hpp"

namespace brickbench::exact {

// free_flight.cpp
ExactCase projectile();
ExactCase constant_force();
ExactCase explosion();
// rotation.cpp
ExactCase uniform_spin();
ExactCase spin_up();
ExactCase torque_free_third_axis();
ExactCase torque_free_first_axis();
ExactCase axis_flip();
ExactCase symmetric_precession();
// bounce.cpp
ExactCase ball_apexes();
ExactCase ball_bounce_times();
ExactCase flat_drop();
ExactCase ball_landing();
ExactCase flat_landing();
ExactCase corner_impact();
ExactCase rod_impact();
// collision.cpp
ExactCase central_spheres();
ExactCase oblique_spheres();
ExactCase central_boxes();
ExactCase off_centre_bricks();
ExactCase cradle();
ExactCase mass_chain();
ExactCase small_on_big();
// friction.cpp
ExactCase incline_slide();
ExactCase incline_creep();
ExactCase incline_threshold();
ExactCase sliding_stop();
ExactCase diagonal_slide();
ExactCase force_ramp();
ExactCase spin_stop();
ExactCase spin_and_slide();
// stacked.cpp
ExactCase stack_pulled_together();
ExactCase stack_pulled_apart();
ExactCase pull_threshold();
// rolling.cpp
ExactCase slide_to_roll();
ExactCase roll_down();
ExactCase slip_down();
ExactCase ball_on_plank();
// statics.cpp
ExactCase block_at_rest();
ExactCase block_on_slope();
ExactCase tower();
ExactCase heavy_on_light();
ExactCase ball_in_groove();
ExactCase leaning_slab();
// tipping.cpp
ExactCase topple_threshold();
ExactCase column_tilt();
ExactCase overhang();
ExactCase curb_impact();
ExactCase kick_threshold();
ExactCase free_topple();
ExactCase rocking_block();
// conservation.cpp
ExactCase elastic_heap();
ExactCase inelastic_heap();
ExactCase painleve();

}  // namespace brickbench::exact
