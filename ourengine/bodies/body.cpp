#include "ourengine/bodies/body.hpp"
