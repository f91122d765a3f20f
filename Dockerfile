# docker build --build-arg UID="$(id -u)" --tag ev-stack .
# mkdir -p results && docker run --rm --volume "$PWD/results:/ev-stack/results" ev-stack shchur2019
FROM python:3.11-slim@sha256:90744cff8f32887f075c47d747a173ff333e9e98801667af93c357fa9f5e28ff
# Results belong to the user with this number, who must not be root.
ARG UID=1000
RUN useradd --create-home --uid "$UID" driver && install --directory --owner driver /ev-stack
USER driver
WORKDIR /ev-stack
COPY --chown=driver . .
RUN UV_NO_CACHE=1 scripts/setup.sh && scripts/compile.sh
ENTRYPOINT ["scripts/run.sh"]
CMD ["--list"]
