# maned on Debian 12. It listens on loopback inside the container until told otherwise; serve other
# machines with
#   -e MANE_LISTEN=0.0.0.0:7420 -e MANE_TLS_CERT=... -e MANE_TLS_KEY=... -e MANE_TOKEN_FILE=...
# or, inside a private network only, with
#   -e MANE_LISTEN=0.0.0.0:7420 -e MANE_INSECURE_NON_LOOPBACK=1
ARG BASE=debian:12-slim

FROM ${BASE} AS build
WORKDIR /src
COPY deploy/packages.txt deploy/packages.txt
RUN apt-get update \
    && awk '$1 == "build" { print $2 }' deploy/packages.txt \
    | DEBIAN_FRONTEND=noninteractive xargs apt-get install -y -q --no-install-recommends
COPY . .
RUN cmake --preset release \
    && cmake --build --preset release --parallel "$(nproc)" --target maned \
    && strip build/release/server/app/maned

FROM ${BASE}
COPY deploy/packages.txt /tmp/packages.txt
RUN apt-get update \
    && awk '$1 == "runtime" { print $2 }' /tmp/packages.txt \
    | DEBIAN_FRONTEND=noninteractive xargs apt-get install -y -q --no-install-recommends \
    && rm -rf /var/lib/apt/lists/* /tmp/packages.txt \
    && useradd --system --user-group --home-dir /var/lib/mane mane \
    && install -d -o mane -g mane /var/lib/mane
COPY --from=build /src/build/release/server/app/maned /usr/local/bin/maned
USER mane
ENV MANE_DATA_DIR=/var/lib/mane
VOLUME /var/lib/mane
EXPOSE 7420
STOPSIGNAL SIGTERM
HEALTHCHECK --interval=10s --timeout=6s --start-period=10s CMD ["maned", "--health-check"]
ENTRYPOINT ["maned"]
