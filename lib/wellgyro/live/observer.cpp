#include "wellgyro/live/observer.h"

namespace wellgyro {

LiveObserver::~LiveObserver() = default;

}  // namespace wellgyro
