#include "beam/test_motion.h"
