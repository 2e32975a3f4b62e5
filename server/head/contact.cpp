#include "head/contact.h"

#include <utility>

#include "head/head.h"

namespace mane::head {

void StartContact(const groom::Groom& /*groom*/, std::shared_ptr<const Bodies> bodies,
                  HeadState* state) {
  state->contact = {std::move(bodies), {}};
  if (state->contact.bodies == nullptr) return;
  state->contact.moving = BodiesAtRest(*state->contact.bodies, state->pose);
}

}  // namespace mane::head
